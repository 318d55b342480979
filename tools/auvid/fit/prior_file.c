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

bool prior_file_write(const auvid_identifier_t *id, const char *path)
{
    uint8_t record[AUVID_PRIOR_BYTES];
    char draft[4096];
    if (auvid_prior_save(id, record) < 0) {
        report_error_line("%s is not written: no parameter is identified", path);
        return false;
    }
    (void)snprintf(draft, sizeof draft, "%s.new", path);
    FILE *file = fopen(draft, "wb");
    bool written = file != NULL && fwrite(record, 1, sizeof record, file) == sizeof record;
    written = file != NULL && fclose(file) == 0 && written;
    if (!written || rename(draft, path) != 0) {
        report_error_line("cannot write %s: %s", path, strerror(errno));
        return false;
    }
    return true;
}
