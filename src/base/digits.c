/* Raffaello Giulietti, The Schubfach way to render doubles (2020), with the layout of %.17g. */
#include "digits.h"

#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

__extension__ typedef unsigned __int128 wide;

/* --- the powers of ten --- */

/* 10^p in 128 bits, the first of which is set: the exact value's, plus one unit of the last
 * (section 8.1 of the paper, which has 126). */
enum { LEAST_POWER = -292, MOST_POWER = 324 };
static struct power { uint64_t high, low; } powers[MOST_POWER - LEAST_POWER + 1];

/* Exact numbers: 5^324 has 753 bits, and 2^896 over 5^292 still has 218. */
enum { WORDS = 16 };

static void multiply_by_5(uint64_t big[WORDS]) {
    uint64_t carry = 0;
    for (int i = 0; i < WORDS; i++) {
        const wide product = (wide)big[i] * 5 + carry;
        big[i] = (uint64_t)product;
        carry = (uint64_t)(product >> 64);
    }
}

/* Rounds down; so does a repetition, as if it were divided once. */
static void divide_by_5(uint64_t big[WORDS]) {
    uint64_t rest = 0;
    for (int i = WORDS - 1; i >= 0; i--) {
        const wide dividend = (wide)rest << 64 | big[i];
        big[i] = (uint64_t)(dividend / 5);
        rest = (uint64_t)(dividend % 5);
    }
}

/* At least two words stand below the first that is not zero. */
static struct power leading_bits(const uint64_t big[WORDS]) {
    int i = WORDS - 1;
    while (big[i] == 0)
        i--;
    wide bits = (wide)big[i] << 64 | big[i - 1];
    const int shift = __builtin_clzll(big[i]);
    if (shift > 0)
        bits = bits << shift | big[i - 2] >> (64 - shift);
    bits++;
    return (struct power){(uint64_t)(bits >> 64), (uint64_t)bits};
}

/* A power of ten has the bits of the power of five. */
static void compute_powers(void) {
    uint64_t up[WORDS] = {0}, down[WORDS] = {0};
    up[2] = down[WORDS - 2] = 1;
    for (int p = 0; p <= MOST_POWER; p++, multiply_by_5(up))
        powers[p - LEAST_POWER] = leading_bits(up);
    for (int p = 0; p >= LEAST_POWER; p--, divide_by_5(down))
        powers[p - LEAST_POWER] = leading_bits(down);
}

/* --- the shortest decimal --- */

struct decimal {
    uint64_t digits;
    int exponent; /* of ten */
};

/* The top 64 bits of a product of 192, with the last set where the rest is not zero. Powers are up
 * to one unit too large: that much of a rest is none. */
static uint64_t round_to_odd(struct power g, uint64_t c) {
    const wide low = (wide)g.low * c;
    const wide high = (wide)g.high * c + (uint64_t)(low >> 64);
    return (uint64_t)(high >> 64) | ((uint64_t)high > 1);
}

/* Figure 4 of the paper: c 2^q, a positive number, whose neighbour below is half as far away as the
 * one above where c is the least of its exponent. */
static struct decimal shortest(uint64_t c, int q, int narrow_below) {
    const int k = (q * 1262611 - (narrow_below ? 524031 : 0)) >> 22; /* log10(2^q), of 3/4 of it */
    const int h = q + ((-k * 1741647) >> 19) + 1;                    /* log2(10^-k) */
    const struct power g = powers[-k - LEAST_POWER];
    const uint64_t open = c & 1; /* an odd number's ends are read back as its neighbours */
    const uint64_t lower = round_to_odd(g, (4 * c - 2 + (uint64_t)narrow_below) << h) + open;
    const uint64_t value = round_to_odd(g, 4 * c << h);
    const uint64_t upper = round_to_odd(g, (4 * c + 2) << h) - open;

    const uint64_t s = value / 4, tens = s / 10;
    if (tens > 0) { /* is there one of the two multiples of ten around it, with a digit less? */
        const int below = lower <= 40 * tens, above = 40 * tens + 40 <= upper;
        if (below != above)
            return (struct decimal){tens + (uint64_t)above, k + 1};
    }
    const int below = lower <= 4 * s, above = 4 * s + 4 <= upper;
    if (below != above)
        return (struct decimal){s + (uint64_t)above, k};
    const uint64_t middle = 4 * s + 2;
    return (struct decimal){s + (value > middle || (value == middle && (s & 1))), k};
}

static struct decimal decimal_of(uint64_t bits) {
    const uint64_t fraction = bits & (((uint64_t)1 << 52) - 1);
    const int exponent = (int)(bits >> 52 & 2047);
    struct decimal d = exponent == 0 ? shortest(fraction, -1074, 0)
                                     : shortest(fraction | (uint64_t)1 << 52, exponent - 1075,
                                                fraction == 0 && exponent > 1);
    while (d.digits % 10 == 0) {
        d.digits /= 10;
        d.exponent++;
    }
    return d;
}

/* --- as text --- */

enum { MOST = 17 }; /* digits of a double */

static char pairs[200];         /* "00" to "99" */
static uint64_t tens[MOST + 1]; /* 10^i */

static void compute_tables(void) {
    for (int i = 0; i < 100; i++) {
        pairs[2 * i] = (char)('0' + i / 10);
        pairs[2 * i + 1] = (char)('0' + i % 10);
    }
    tens[0] = 1;
    for (int i = 1; i <= MOST; i++)
        tens[i] = 10 * tens[i - 1];
}

static void put_pair(char *text, uint32_t n) {
    memcpy(text, pairs + 2 * n, 2);
}

static void put_8(char *text, uint32_t n) {
    const uint32_t high = n / 10000, low = n % 10000;
    put_pair(text, high / 100);
    put_pair(text + 2, high % 100);
    put_pair(text + 4, low / 100);
    put_pair(text + 6, low % 100);
}

/* From the bits' number; 1233 / 4096 is log10(2). Of 0 it is one digit. */
static int count_digits(uint64_t n) {
    const int count = (64 - __builtin_clzll(n | 1)) * 1233 >> 12;
    return count + (n >= tens[count]) + (n == 0);
}

/* Writes all digits at `text`, which has room for 24; returns how many there are. */
static int put_digits(char *text, uint64_t n) {
    char padded[24 + 24];
    const int count = count_digits(n);
    const uint64_t high = n / 100000000;
    put_8(padded + 16, (uint32_t)(n % 100000000));
    put_8(padded + 8, (uint32_t)(high % 100000000));
    put_8(padded, (uint32_t)(high / 100000000));
    memcpy(text, padded + 24 - count, 24);
    return count;
}

static char *put_exponent(char *text, int exponent) {
    *text++ = 'e';
    *text++ = exponent < 0 ? '-' : '+';
    const uint32_t size = (uint32_t)(exponent < 0 ? -exponent : exponent);
    if (size >= 100)
        *text++ = (char)('0' + size / 100);
    put_pair(text, size % 100);
    return text + 2;
}

/* As %.17g: as a fraction from 1e-4 up to 1e17. Copies are of a fixed length, beyond the end. */
static char *lay_out(char *text, struct decimal d) {
    char digits[48];
    const int count = put_digits(digits, d.digits);
    const int exponent = d.exponent + count - 1; /* of the first digit */
    if (exponent < -4 || exponent >= MOST) {
        text[0] = digits[0];
        text[1] = '.';
        memcpy(text + 2, digits + 1, 24);
        return put_exponent(text + (count > 1 ? count + 1 : 1), exponent);
    }
    if (exponent < 0) {
        memcpy(text, "0.000", 5);
        memcpy(text + 1 - exponent, digits, 24);
        return text + 1 - exponent + count;
    }
    memcpy(text, digits, 24);
    if (d.exponent >= 0) {
        memset(text + count, '0', (size_t)d.exponent);
        return text + count + d.exponent;
    }
    text[exponent + 1] = '.';
    memcpy(text + exponent + 2, digits + exponent + 1, 24);
    return text + count + 1;
}

static void prepare(void) {
    compute_powers();
    compute_tables();
}

char *digits_put(char *text, double x) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    uint64_t bits;
    pthread_once(&once, prepare);
    if (!isfinite(x))
        return text + sprintf(text, "%g", x);
    if (signbit(x))
        *text++ = '-';
    x = fabs(x);
    memcpy(&bits, &x, sizeof bits);
    const int whole = x < 9007199254740992.; /* 2^53 */
    if (whole && x == (double)(int64_t)x)
        text += put_digits(text, (uint64_t)x);
    else
        text = lay_out(text, decimal_of(bits));
    *text = '\0';
    return text;
}

const char *digits_text(char text[DIGITS_SIZE], double x) {
    digits_put(text, x);
    return text;
}
