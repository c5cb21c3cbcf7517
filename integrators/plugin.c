#include "plugin.h"

#include "base/complain.h"
#include "base/files.h"
#include "base/visible.h"

#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Whoever changes one of these structs raises STEPPER_INTERFACE, and writes the new sizes here. */
#if __SIZEOF_POINTER__ == 8
_Static_assert(sizeof(struct stepper_method) == 184 && sizeof(struct stepper_settings) == 40 &&
                   sizeof(struct system) == 536 && sizeof(struct system_ops) == 104 &&
                   sizeof(struct part_equation) == 56 && sizeof(struct linear_method) == 88 &&
                   sizeof(struct option_spec) == 56 && sizeof(struct butcher_table) == 32,
               "a struct of plug-ins has changed: raise STEPPER_INTERFACE");
#endif

static struct plugin *loaded; /* NULL: none was */

const struct plugin *plugins(void) {
    static const struct plugin none = {.method = NULL};
    return loaded ? loaded : &none;
}

const struct plugin *plugin_of(const struct stepper_method *method) {
    for (const struct plugin *p = plugins(); p->method; p++)
        if (p->method == method)
            return p;
    return NULL;
}

/* --- ends that are not the program's own --- */

static pid_t loader; /* the process that says a last word; those of runs are looked after by it */
static const char crashed[] = "crashed, having loaded";
static char last_word[sizeof crashed + 2 * PATH_SIZE];
static const char *loading; /* the file that is being loaded, or NULL */
static int may_end;

static void on_crash(int number) {
    if (getpid() == loader) {
        complain_last(last_word);
        _exit(1);
    }
    signal(number, SIG_DFL);
    raise(number);
}

/* Whoever calls exit() in a plug-in says that all is well, which nobody can know. */
static void on_exit_call(void) {
    if (may_end || getpid() != loader)
        return;
    fflush(stdout);
    if (loading)
        complain(1, "--plugin %.150s: ends the program while it is loaded: it calls exit", loading);
    else
        complain(1, "a plug-in has called exit; loaded are%s", last_word + sizeof crashed - 1);
    _exit(1);
}

void plugins_let_end(void) {
    may_end = 1;
}

/* Crashes on a stack of their own, for the plug-in may have used up the other one. */
static void watch_for_ends(const char *file) {
    static const int fatal[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
    static char stack[65536];
    const struct sigaction action = {.sa_handler = on_crash, .sa_flags = SA_ONSTACK};
    char shown[PATH_SIZE];
    if (!loader) {
        memcpy(last_word, crashed, sizeof crashed);
        atexit(on_exit_call);
        at_quick_exit(on_exit_call);
    }
    loader = getpid();
    const size_t used = strlen(last_word);
    visible_text(file, shown, sizeof shown);
    snprintf(last_word + used, sizeof last_word - used, "%s %s", loaded ? "," : "", shown);
    sigaltstack(&(stack_t){.ss_sp = stack, .ss_size = sizeof stack}, NULL);
    for (size_t i = 0; i < sizeof fatal / sizeof *fatal; i++)
        sigaction(fatal[i], &action, NULL);
}

/* --- loading --- */

static int refuse(const char *file, const char *why, char *reason) {
    return fail_with(reason, "%.150s: %s", file, why);
}

/* The whole path of a file that can be a plug-in, for free, and its hash; NULL with a reason. (Who
 * opens another kind of file than a regular one may wait for ever.) */
static char *path_of(const char *file, char hash[HASH_SIZE], char *reason) {
    FILE *stream = open_regular(file);
    char *path = stream ? realpath(file, NULL) : NULL;
    const int failed = !path || hash_file(path, hash);
    if (failed)
        refuse(file, errno == EINVAL ? "is no file" : strerror(errno), reason);
    if (stream)
        fclose(stream);
    if (!failed)
        return path;
    free(path);
    return NULL;
}

/* What the plug-in exports; NULL with a reason. The linker's words begin with the path, which the
 * user may have written otherwise. */
static const struct stepper_plugin *open_plugin(const char *file, const char *path, char *reason) {
    loading = file;
    void *object = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    loading = NULL;
    const struct stepper_plugin *plugin = object ? dlsym(object, "wisplab_plugin") : NULL;
    if (!object) {
        const char *words = dlerror(),
                   *after = strstr(words, path) == words ? strchr(words, ':') : 0;
        refuse(file, after ? after + 2 : words, reason);
    } else if (!plugin) {
        refuse(file, "exports no wisplab_plugin, which the line STEPPER_PLUGIN(...) makes", reason);
    }
    return plugin;
}

static int is_name(const char *name) {
    static const char letters[] = "abcdefghijklmnopqrstuvwxyz0123456789-";
    return name && *name && name[strspn(name, letters)] == '\0';
}

/* What must be in the table of a method and is not; NULL: all is. */
static const char *missing_of(const struct stepper_method *method) {
    if (!method)
        return "method";
    const int adaptive = (method->capabilities & STEPPER_ADAPTIVE) != 0;
    return !is_name(method->name)         ? "name of small letters, digits and hyphens"
           : !method->summary             ? "summary"
           : !method->reference           ? "reference"
           : !method->create              ? "function create"
           : !method->free                ? "function free"
           : adaptive && !method->advance ? "function advance, and is adaptive"
           : !adaptive && !method->step   ? "function step, and is not adaptive"
                                          : NULL;
}

/* Whether its method can be taken into the list: 0, or -1 with a reason. */
static int check(const struct stepper_plugin *plugin, const char *file, char *reason) {
    char why[200];
    if (plugin->interface != STEPPER_INTERFACE) {
        snprintf(why, sizeof why,
                 "has version %d of the stepper interface, not %d; compile it with the headers of "
                 "this wisplab",
                 plugin->interface, STEPPER_INTERFACE);
        return refuse(file, why, reason);
    }
    const char *missing = missing_of(plugin->method);
    if (missing) {
        snprintf(why, sizeof why, "its stepper has no %s", missing);
        return refuse(file, why, reason);
    }
    const struct stepper_method *other = stepper_find(plugin->method->name);
    if (!other)
        return 0;
    snprintf(why, sizeof why, "its stepper is called '%.60s', as %s is; give it another name",
             other->name, plugin_of(other) ? "another plug-in's" : "one of wisplab's own");
    return refuse(file, why, reason);
}

/* Takes the path over. Returns 0, or -1 with a reason where memory cannot be had. */
static int keep(const struct stepper_method *method, char *path, const char *hash, char *reason) {
    size_t count = 0;
    while (plugins()[count].method)
        count++;
    struct plugin *more = realloc(loaded, (count + 2) * sizeof *more);
    if (more) {
        loaded = more;
        loaded[count] = loaded[count + 1] = (struct plugin){.method = NULL};
    }
    if (!more || stepper_add(method))
        return refuse(path, "out of memory", reason);
    loaded[count] = (struct plugin){.method = method, .path = path};
    memcpy(loaded[count].hash, hash, HASH_SIZE);
    return 0;
}

int plugin_load(const char *file, char *reason) {
    char hash[HASH_SIZE];
    char *path = path_of(file, hash, reason);
    if (!path)
        return -1;
    watch_for_ends(file);
    const struct stepper_plugin *plugin = open_plugin(file, path, reason);
    if (plugin && check(plugin, file, reason) == 0 && keep(plugin->method, path, hash, reason) == 0)
        return 0;
    free(path);
    return -1;
}
