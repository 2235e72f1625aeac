/* Entry point of the Windows library, which is linked without a C run-time library.
 * A compiler that brings its own run-time library (sources/ of an FMU) leaves this file out. */

int __stdcall DllMainCRTStartup(void *library, unsigned long reason, void *reserved)
{
    (void)library;
    (void)reason;
    (void)reserved;
    return 1;
}
