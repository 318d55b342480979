/*
 * The prior record as a file.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "auvid/prior.h"
#include "../base/report_error.h"
#include "prior_file.h"

bool prior_file_read(auvid_identifier_t *id, auvid_prior_t *storage, const char *path)
{
    uint8_t record[AUVID_PRIOR_BYTES + 1]; /* one byte too many, to detect a longer file */
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        report_error_line("%s: %s: starting without a prior", path, strerror(errno));
        return false;
    }
    size_t bytes = fread(record, 1, sizeof record, file);
    (void)fclose(file);
    auvid_status_t status = auvid_identifier_attach_prior(id, storage);
    status = status < 0 ? status : auvid_prior_load(id, record, (uint32_t)bytes);
    if (status < 0) {
        const char *why = status == AUVID_ERR_MODEL  ? "the prior record of another model"
                          : status == AUVID_ERR_SIZE ? "not a prior record"
                                                     : "a damaged prior record";
        report_error_line("%s is %s: starting without a prior", path, why);
    }
    return status >= 0;
}

void prior_file_judge(const auvid_prior_t *storage, const char *path)
{
    if (storage->known == 0) {
        report_warning(
            "%s: the data contradict this prior record, and it was discarded: of another "
            "vehicle, payload or thrusters?",
            path);
    }
}

/* The name under which the record is written first. */
typedef char draft_t[4096];

static FILE *open_draft(const char *path, draft_t draft)
{
    (void)snprintf(draft, sizeof(draft_t), "%s.new", path);
    return fopen(draft, "wb");
}

int prior_file_check(const char *path)
{
    draft_t draft;
    FILE *old = fopen(path, "r+b"); /* fails for a folder, which a file cannot replace */
    bool folder = old == NULL && errno == EISDIR;
    if (old != NULL) {
        (void)fclose(old);
    }
    FILE *file = folder ? NULL : open_draft(path, draft);
    if (file == NULL) {
        return report_error("cannot write %s: %s", path, strerror(errno));
    }
    (void)fclose(file);
    (void)remove(draft);
    return 0;
}

bool prior_file_write(const auvid_identifier_t *id, const char *path)
{
    uint8_t record[AUVID_PRIOR_BYTES];
    draft_t draft;
    if (auvid_prior_save(id, record) < 0) {
        report_error_line("%s is not written: no parameter is identified", path);
        return false;
    }
    FILE *file = open_draft(path, draft);
    bool written = file != NULL && fwrite(record, 1, sizeof record, file) == sizeof record;
    written = file != NULL && fclose(file) == 0 && written;
    if (!written || rename(draft, path) != 0) {
        report_error_line("cannot write %s: %s", path, strerror(errno));
        return false;
    }
    return true;
}
