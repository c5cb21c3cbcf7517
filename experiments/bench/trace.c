/* What an evaluation executes: a child process goes through it one instruction at a time, and its
 * parent, which has the same program at the same addresses, looks at each. This ties the table of
 * needed operations to the compiled code, and shows what the code does besides. On processors and
 * systems other than x86-64 Linux there are no counts. */
#include "base/owner.h"
#include "measure.h"

#include <string.h>

const char *const executed_names[EXECUTED_KINDS] = {
    "square roots", "divisions", "additions", "logic", "arranging", "moves", "other", "library",
};

#if defined __x86_64__ && defined __linux__

#include <signal.h>
#include <sys/ptrace.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

extern const unsigned char __executable_start, etext; /* the linker's: where the program is */

/* An instruction as far as it matters here. */
struct instruction {
    int vector; /* SSE or AVX */
    int map;    /* 1: 0F, 2: 0F38, 3: 0F3A */
    int prefix; /* 0: none, 1: 66, 2: F3, 3: F2 */
    int opcode;
    int width; /* doubles: of a packed instruction 2, 4 or 8, else 1 */
};

static int packed(const struct instruction *in, int width) {
    return in->prefix >= 2 ? 1 : width;
}

/* VEX of 2 or 3 bytes, EVEX, or the old encoding with its prefixes (Intel SDM, volume 2, 2.3). */
static struct instruction decode(const unsigned char *at) {
    struct instruction in = {.map = 1};
    if (at[0] == 0xC5) {
        in.vector = 1, in.prefix = at[1] & 3, in.opcode = at[2];
        in.width = packed(&in, at[1] & 4 ? 4 : 2);
    } else if (at[0] == 0xC4) {
        in.vector = 1, in.map = at[1] & 31, in.prefix = at[2] & 3, in.opcode = at[3];
        in.width = packed(&in, at[2] & 4 ? 4 : 2);
    } else if (at[0] == 0x62) {
        in.vector = 1, in.map = at[1] & 7, in.prefix = at[2] & 3, in.opcode = at[4];
        in.width = packed(&in, 2 << (at[3] >> 5 & 3));
    } else {
        while (*at == 0x66 || *at == 0xF2 || *at == 0xF3 || (*at & 0xF0) == 0x40) {
            in.prefix = *at == 0x66 ? 1 : *at == 0xF3 ? 2 : *at == 0xF2 ? 3 : in.prefix;
            at++;
        }
        /* of 0F ..: 10 to 17, 28 to 2F, 50 to 7F, C2 to C6 and from D0 on are SSE */
        const int op = at[1];
        in.vector =
            at[0] == 0x0F && ((op & 0xF8) == 0x10 || (op & 0xF8) == 0x28 ||
                              (op >= 0x50 && op < 0x80) || op == 0xC2 || op == 0xC6 || op >= 0xD0);
        in.opcode = op;
        in.width = packed(&in, 2);
    }
    return in;
}

static int is_move(int opcode) {
    switch (opcode) {
    case 0x10:
    case 0x11:
    case 0x28:
    case 0x29:
    case 0x2B:
    case 0x6E:
    case 0x6F:
    case 0x7E:
    case 0x7F:
    case 0xD6:
    case 0xE7:
        return 1;
    default:
        return 0;
    }
}

static int is_arranging(int opcode) {
    switch (opcode) {
    case 0x12:
    case 0x13:
    case 0x14:
    case 0x15:
    case 0x16:
    case 0x17:
    case 0x70:
    case 0x73:
    case 0x6C:
    case 0x6D:
    case 0xC6:
        return 1;
    default:
        return 0;
    }
}

static enum executed kind_of(const struct instruction *in) {
    if (!in->vector)
        return EXECUTED_OTHER;
    if (in->map == 2) /* broadcasts from memory are loads */
        return in->opcode >= 0x18 && in->opcode <= 0x1B ? EXECUTED_MOVES : EXECUTED_LOGIC;
    if (in->map == 3)
        return in->opcode == 0x4B || in->opcode == 0x25 || in->opcode == 0x1F ? EXECUTED_LOGIC
                                                                              : EXECUTED_ARRANGING;
    switch (in->opcode) {
    case 0x51:
        return EXECUTED_SQUARE_ROOTS;
    case 0x5E:
        return EXECUTED_DIVISIONS;
    case 0x58:
    case 0x59:
    case 0x5C:
        return EXECUTED_ARITHMETIC;
    default:
        return is_move(in->opcode)        ? EXECUTED_MOVES
               : is_arranging(in->opcode) ? EXECUTED_ARRANGING
                                          : EXECUTED_LOGIC;
    }
}

static void tally(unsigned long long at, int lanes, double executed[EXECUTED_KINDS]) {
    const unsigned char *code = (const unsigned char *)at;
    if (code < &__executable_start || code >= &etext) {
        executed[EXECUTED_LIBRARY]++;
        return;
    }
    const struct instruction in = decode(code);
    const enum executed kind = kind_of(&in);
    executed[kind] += kind <= EXECUTED_ARITHMETIC ? (double)in.width / lanes : 1;
}

/* Follows the child from the first instruction of `function` to its return. */
static int follow(pid_t pid, unsigned long long function, int lanes,
                  double executed[EXECUTED_KINDS]) {
    unsigned long long home = 0;
    for (long step = 0; step < 1000000; step++) {
        struct user_regs_struct registers;
        int status;
        if (ptrace(PTRACE_SINGLESTEP, pid, NULL, NULL) || waitpid(pid, &status, 0) != pid ||
            !WIFSTOPPED(status) || ptrace(PTRACE_GETREGS, pid, NULL, &registers))
            return -1;
        if (registers.rip == function)
            home = (unsigned long long)ptrace(PTRACE_PEEKDATA, pid, registers.rsp, NULL);
        else if (home && registers.rip == home)
            return 0;
        if (home)
            tally(registers.rip, lanes, executed);
    }
    return -1;
}

int trace_evaluation(struct system *system, const double *q, const double *v, double *a,
                     double executed[EXECUTED_KINDS]) {
    int status, code = -1;
    memset(executed, 0, EXECUTED_KINDS * sizeof *executed);
    const pid_t pid = fork();
    if (pid == 0) {
        if (ptrace(PTRACE_TRACEME, 0, NULL, NULL) == 0 && raise(SIGSTOP) == 0)
            system->ops->acceleration(system->ctx, 0, q, v, a);
        _exit(0);
    }
    if (pid < 0 || waitpid(pid, &status, 0) != pid)
        return -1;
    unsigned long long function;
    memcpy(&function, &system->ops->acceleration, sizeof function);
    if (WIFSTOPPED(status))
        code = follow(pid, function, system->lanes, executed);
    signal_process(pid, SIGKILL);
    waitpid(pid, &status, 0);
    return code;
}

#else

int trace_evaluation(struct system *system, const double *q, const double *v, double *a,
                     double executed[EXECUTED_KINDS]) {
    (void)system, (void)q, (void)v, (void)a, (void)executed;
    return -1;
}

#endif
