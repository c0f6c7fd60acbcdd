/* Vector kernels: Debian builds SUNDIALS without wide vector instructions and without restrict. */
#ifndef VECTORS_H
#define VECTORS_H

#include <nvector/nvector_serial.h>

/* Puts these kernels in the place of those of a serial vector; its clones keep them. */
void vectors_replace(N_Vector vector);

#endif
