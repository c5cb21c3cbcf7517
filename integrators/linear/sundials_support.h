/* What the users of SUNDIALS share: a context of their own, silent, and fast vectors. */
#ifndef WISPLAB_SUNDIALS_SUPPORT_H
#define WISPLAB_SUNDIALS_SUPPORT_H

#include <sundials/sundials_config.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_nvector.h>

/* Names of SUNDIALS 7, written below for 6.4. */
#if SUNDIALS_VERSION_MAJOR < 7
#define SUN_COMM_NULL    NULL
#define SUN_ERR_EXT_FAIL SUNLS_PACKAGE_FAIL_UNREC
#endif

/* One for each stepper or solver: contexts are cheap and must not be shared by threads. */
struct sundials {
    SUNContext context;
    char message[160]; /* the last error or warning, which is not printed */
};

/* Returns 0, or -1 where memory cannot be had; then there is nothing to close. */
int sundials_open(struct sundials *sundials);
void sundials_close(struct sundials *sundials);

/* A vector of `size` doubles, all 0, or NULL. It and its clones use the loops of this file. */
N_Vector sundials_vector(struct sundials *sundials, int size);

#if SUNDIALS_VERSION_MAJOR < 7
/* The CVErrHandlerFn that keeps the message; from 7 on the context has one for all. */
void sundials_keep_message(int code, const char *module, const char *function, char *text,
                           void *sundials);
#endif

#endif
