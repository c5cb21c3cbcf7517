/* Numbers as text: read back to the same bits, with no digit too many. The C library's printf and
 * strtod, which round correctly, are what they are compared with. */
#include "base/digits.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double of_bits(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static uint64_t bits_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* Marsaglia's xorshift */
static uint64_t draw(uint64_t *state) {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state;
}

static void reads_back(double x) {
    char text[DIGITS_SIZE], plain[64];
    const char *end = digits_put(text, x);
    cr_assert(*end == '\0' && strlen(text) == (size_t)(end - text), "%s", text);
    cr_assert_eq(bits_of(strtod(text, NULL)), bits_of(x), "%.17g: %s", x, text);
    snprintf(plain, sizeof plain, "%.17g", x);
    cr_assert(strlen(text) <= strlen(plain), "%s is longer than %s", text, plain);
}

/* The digits of a text of any form, without zeros at either end; returns how many they are. */
static int significant(const char *text, char digits[64]) {
    int count = 0;
    for (; *text && *text != 'e'; text++)
        if (strchr("123456789", *text) || (*text == '0' && count > 0))
            digits[count++] = *text;
    while (count > 0 && digits[count - 1] == '0')
        count--;
    digits[count] = '\0';
    return count;
}

/* With a digit less, neither of the two decimals around x is read back as x; and with as many,
 * the nearest is the one that was written, where that is read back as x. (A power of two has its
 * neighbour below at half the distance: the nearest may be there.) */
static void is_shortest(double x) {
    char text[DIGITS_SIZE], other[64], digits[64], other_digits[64];
    digits_put(text, x);
    const int count = significant(text, digits);
    for (int up = -1; up <= 1 && count > 1; up++) {
        snprintf(other, sizeof other, "%.*e", count - 2, x);
        const double step = pow(10, floor(log10(fabs(x))) - count + 2);
        snprintf(other, sizeof other, "%.*e", count - 2, strtod(other, NULL) + up * step);
        cr_assert(strtod(other, NULL) != x, "%s could be %s", text, other);
    }
    snprintf(other, sizeof other, "%.*g", count, x);
    significant(other, other_digits);
    cr_assert(strtod(other, NULL) != x || strcmp(digits, other_digits) == 0, "%s, not %s", text,
              other);
}

/* The number, its neighbours and theirs. */
static void around(double x, void (*check)(double)) {
    for (int k = -3; k <= 3; k++) {
        const double y = of_bits(bits_of(x) + (uint64_t)k);
        if (y != 0 && isfinite(y))
            check(y);
    }
}

Test(digits, random_numbers_are_read_back_to_the_same_bits) {
    uint64_t state = 88172645463325252;
    for (int i = 0; i < 1000000; i++) {
        const uint64_t bits = draw(&state);
        const double small = of_bits(bits & ~((uint64_t)2047 << 52)); /* without its exponent */
        if (isfinite(of_bits(bits)))
            reads_back(of_bits(bits));
        reads_back((double)(bits >> 11) * ldexp(1, -40 - i % 30)); /* of the size of states */
        if (i % 4 == 0)
            reads_back(small);
    }
}

Test(digits, numbers_have_no_digit_too_many) {
    uint64_t state = 88172645463325252;
    for (int i = 0; i < 50000; i++) {
        const uint64_t bits = draw(&state);
        const double small = of_bits(bits & ~((uint64_t)2047 << 52));
        if (isfinite(of_bits(bits)))
            is_shortest(of_bits(bits));
        is_shortest((double)(bits >> (11 + i % 40)) * ldexp(1, -40 - i % 30));
        if (small != 0)
            is_shortest(small);
    }
}

Test(digits, powers_of_two_and_of_ten_and_their_neighbours) {
    for (int e = -1074; e < 1024; e++) {
        around(ldexp(1, e), reads_back);
        around(ldexp(1, e), is_shortest);
    }
    for (int e = -323; e <= 308; e++) {
        char text[16];
        snprintf(text, sizeof text, "1e%d", e);
        around(strtod(text, NULL), reads_back);
        around(strtod(text, NULL), is_shortest);
    }
}

/* Decimals of few digits are what a user has typed: they come out as they went in. */
Test(digits, short_decimals_stay_short) {
    for (int digits = 1; digits < 20000; digits += 7)
        for (int e = -30; e <= 25; e++) {
            char typed[32], plain[32];
            snprintf(typed, sizeof typed, "%de%d", digits, e);
            snprintf(plain, sizeof plain, "%.15g", strtod(typed, NULL));
            if (e < 10) /* beyond, %.15g has an exponent where %.17g has zeros */
                cr_assert_str_eq(DIGITS(strtod(typed, NULL)), plain);
            reads_back(strtod(typed, NULL));
        }
}

Test(digits, are_laid_out_as_printf_does) {
    static const struct {
        double x;
        const char *text;
    } cases[] = {{0, "0"},
                 {-0., "-0"},
                 {1, "1"},
                 {-12, "-12"},
                 {0.1, "0.1"},
                 {-0.0001, "-0.0001"},
                 {1e-5, "1e-05"},
                 {1.5e-7, "1.5e-07"},
                 {123456.789, "123456.789"},
                 {9007199254740991, "9007199254740991"},
                 {9007199254740992, "9007199254740992"},
                 {1e16, "10000000000000000"},
                 {1e17, "1e+17"},
                 {1e22, "1e+22"},
                 {1e300, "1e+300"},
                 {5e-324, "5e-324"},
                 {2.2250738585072014e-308, "2.2250738585072014e-308"},
                 {1.7976931348623157e308, "1.7976931348623157e+308"},
                 {INFINITY, "inf"},
                 {-INFINITY, "-inf"},
                 {NAN, "nan"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        cr_assert_str_eq(DIGITS(cases[i].x), cases[i].text);
    for (int i = -5000; i < 5000; i++) {
        char plain[64];
        snprintf(plain, sizeof plain, "%.17g", (double)i * 12345678);
        cr_assert_str_eq(DIGITS((double)i * 12345678), plain);
    }
}
