/* What the library shows of itself: FMI's functions, and its own for runs without an FMU. */
#ifndef AUTOBALANCER_EXPORT_H
#define AUTOBALANCER_EXPORT_H

#if defined _WIN32
#define EXPORT __declspec(dllexport)
#elif defined __GNUC__
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

#endif
