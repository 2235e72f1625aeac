#include "fmi/resource.h"

#include "fmi/unit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PATH = 4096, MOST_TEXT = 1 << 20 };

/* Where the path begins in file:///p, file:/p and file://localhost/p (RFC 8089); //host/p with
   another host. */
static const char *path_in(const char *uri)
{
    const char *at = uri + strlen("file:");
    if (!strncmp(at, "//", 2)) {
        at += !strncmp(at, "///", 3)                                     ? 2
              : !strncmp(at, "//localhost/", strlen("//localhost/")) ? strlen("//localhost")
                                                                         : 0;
    }
    return at[0] == '/' && at[1] && at[2] == ':' ? at + 1 : at; /* a drive of Windows */
}

/* Path of a file in a folder named by a URI or a path; 1 where it is too long.  `decodes`: %41 of a URI
   is A. */
static int find(const char *folder, const char *name, int decodes, char *path)
{
    const bool is_uri = !strncmp(folder, "file:", strlen("file:"));
    size_t length = 0;
    for (folder = is_uri ? path_in(folder) : folder; *folder; folder++) {
        const int escaped = decodes && is_uri && *folder == '%' && text_digit(folder[1]) < 16 && text_digit(folder[2]) < 16;
        if (length + strlen(name) + 2 >= MOST_PATH) {
            return 1;
        }
        path[length++] = (char)(escaped ? 16 * text_digit(folder[1]) + text_digit(folder[2]) : *folder);
        folder += escaped ? 2 : 0;
    }
    if (length && path[length - 1] != '/' && path[length - 1] != '\\') {
        path[length++] = '/';
    }
    memcpy(path + length, name, strlen(name) + 1);
    return 0;
}

#ifdef _WIN32
/* UTF-8 as UTF-16: fopen takes a path in the code page of the system, in which there may be none. */
static FILE *opened(const char *path)
{
    wchar_t wide[MOST_PATH];
    size_t length = 0;
    while (*path) {
        const unsigned char lead = (unsigned char)*path++;
        int more = lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : lead >= 0xC0 ? 1 : 0;
        unsigned long code = more ? lead & (0x3Fu >> more) : lead;
        for (; more && *path; more--) {
            code = code << 6 | ((unsigned char)*path++ & 0x3Fu);
        }
        if (code >= 0x10000) {
            wide[length++] = (wchar_t)(0xD7C0 + (code >> 10));
            code = 0xDC00 | (code & 0x3FF);
        }
        wide[length++] = (wchar_t)code;
    }
    wide[length] = 0;
    return _wfopen(wide, L"rb");
}
#else
static FILE *opened(const char *path)
{
    return fopen(path, "rb");
}
#endif

static char *refuse_resource(const char *name, const char *path, const char *why, Text *reason)
{
    text_format(reason, "resources: %s%s%s", name, why, path);
    return NULL;
}

char *resource_text(const char *folder, const char *name, Text *reason)
{
    char path[MOST_PATH];
    char *text;
    FILE *file;
    size_t length;
    if (!folder || find(folder, name, 1, path)) {
        return refuse_resource(name, folder ? folder : "none",
                               ": the resource path is missing or too long: ", reason);
    }
    file = opened(path);
    if (!file && !find(folder, name, 0, path)) { /* some hosts write a path as a URI as it is */
        file = opened(path);
    }
    if (!file) {
        return refuse_resource(name, path, ": cannot be opened as ", reason);
    }
    text = calloc(MOST_TEXT, 1);
    length = text ? fread(text, 1, MOST_TEXT, file) : 0;
    fclose(file);
    if (!text) {
        return refuse_resource(name, path, ": not enough memory to read ", reason);
    }
    if (length == MOST_TEXT) {
        free(text);
        return refuse_resource(name, path, ": too long: ", reason);
    }
    return text;
}
