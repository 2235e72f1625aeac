/* Windows, over kernel32 alone. */
#include "system.h"

enum { INPUT = -10, OUTPUT = -11 };

__declspec(dllimport) void *__stdcall GetStdHandle(unsigned long);
__declspec(dllimport) int __stdcall ReadFile(void *, void *, unsigned long, unsigned long *, void *);
__declspec(dllimport) int __stdcall WriteFile(void *, const void *, unsigned long, unsigned long *,
                                              void *);
__declspec(dllimport) void __stdcall ExitProcess(unsigned);
__declspec(dllimport) void *__stdcall LoadLibraryA(const char *);
__declspec(dllimport) void *__stdcall GetProcAddress(void *, const char *);

size_t system_read(char *buffer, size_t size)
{
    unsigned long count = 0;
    if (!ReadFile(GetStdHandle((unsigned long)INPUT), buffer, (unsigned long)size, &count, NULL))
        return 0;
    return count;
}

void system_write(const char *text, size_t length)
{
    unsigned long count;
    if (!WriteFile(GetStdHandle((unsigned long)OUTPUT), text, (unsigned long)length, &count, NULL))
        ExitProcess(2);
}

void system_exit(int code)
{
    ExitProcess((unsigned)code);
}

void *system_open(const char *library)
{
    return LoadLibraryA(library);
}

void *system_symbol(void *library, const char *name)
{
    return GetProcAddress(library, name);
}

void mainCRTStartup(void)
{
    run();
}
