/* Under a sanitizer, which has its own malloc, nothing is counted. */
unsigned long allocations(void);

unsigned long allocations(void)
{
    return 0;
}
