#include "json_string.h"

/* Number of bytes of the UTF-8 character at text; 0: it is none. Of its second byte the limits are
 * narrower after some first ones: no longer form than needed, no surrogate, up to U+10FFFF. */
static int utf8_bytes(const unsigned char *text)
{
    int more = text[0] < 0x80   ? 0
               : text[0] < 0xc2 ? -1
               : text[0] < 0xe0 ? 1
               : text[0] < 0xf0 ? 2
                                : 3;
    unsigned least = text[0] == 0xe0 ? 0xa0 : text[0] == 0xf0 ? 0x90 : 0x80;
    unsigned most = text[0] == 0xed ? 0x9f : text[0] == 0xf4 ? 0x8f : 0xbf;
    if (more < 0 || text[0] > 0xf4) {
        return 0;
    }
    for (int i = 1; i <= more; ++i) {
        if (text[i] < least || text[i] > most) {
            return 0;
        }
        least = 0x80;
        most = 0xbf;
    }
    return 1 + more;
}

void json_string(FILE *out, const char *text)
{
    const unsigned char *at = (const unsigned char *)text;
    fputc('"', out);
    while (*at != 0) {
        int bytes = utf8_bytes(at);
        if (bytes == 0) {
            fprintf(out, "\\ufffd");
        } else if (*at == '"' || *at == '\\' || *at == '<' || *at < 0x20) {
            fprintf(out, "\\u%04x", *at);
        } else {
            fprintf(out, "%.*s", bytes, (const char *)at);
        }
        at += bytes > 0 ? bytes : 1;
    }
    fputc('"', out);
}
