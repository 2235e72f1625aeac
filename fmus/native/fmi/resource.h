/* Texts among the resources of an FMU. */
#ifndef AUTOBALANCER_RESOURCE_H
#define AUTOBALANCER_RESOURCE_H

#include "base/text.h"

/* The text of a file in the folder that a host names, by a URI (FMI 2.0) or a path (FMI 3.0), in memory
   to be freed; NULL with the reason. */
char *resource_text(const char *folder, const char *name, Text *reason);

#endif
