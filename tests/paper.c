/* Figures for papers: their sizes, their letters, and what was chosen. */
#include "base/files.h"
#include "support.h"

#include <criterion/criterion.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static char *folder;

/* Tables without figures, which take most of the time. */
static void make_tables(void) {
    folder = folder_make();
    gnuplot_stub_quiet();
    WORKS("experiment", "circle", "--quick", "--stepper", "rk4", "--stepper", "euler", "--stepper",
          "midpoint", "--out", folder);
    gnuplot_unstub();
}

static char *text_of(const char *name) {
    return file_of(printed("%s/circle/paper", folder), name);
}

static void plot(const char *paper, const char *const *more) {
    const char *words[20] = {"plot", "circle", "--paper", paper, "--out", folder};
    for (int i = 0; more[i]; i++)
        words[6 + i] = more[i];
    program_must(NULL, 0, NULL, words);
}

/* 86 and 178 mm; a point of a PDF is 0.35 mm. */
static void check_sizes(const char *paper, double width) {
    double points = 0, mm = 0, units = 1, least = INFINITY;
    const char *name = printed("work-precision-%s.pdf", paper);
    FILE *file = fopen(printed("%s/circle/paper/%s", folder, name), "rb");
    for (char line[4096]; file && fgets(line, sizeof line, file);) {
        const char *box = strstr(line, "/MediaBox [ 0 0 ");
        if (box)
            sscanf(box, "/MediaBox [ 0 0 %lf", &points);
    }
    if (file)
        fclose(file);
    cr_expect_float_eq(points / 72 * 25.4, width, 0.4, "%s: %g points", name, points);

    name = printed("work-precision-%s.svg", paper);
    char *svg = text_of(name);
    sscanf(strstr(svg, "width=\""), "width=\"%lfmm", &mm);
    sscanf(strstr(svg, "viewBox=\""), "viewBox=\"0 0 %lf", &units);
    cr_expect_float_eq(mm, width, 0.15, "%s: %g mm", name, mm);
    for (const char *at = svg; (at = strstr(at, "font-size=\"")) != NULL; at++) {
        const double size = strtod(at + strlen("font-size=\""), NULL) * mm / units / 25.4 * 72;
        cr_expect(size < 8.4, "%s: letters of %g points", name, size);
        least = fmin(least, size);
    }
    cr_expect(least >= 0.8 * 7 - 0.01, "%s: letters of %g points, exponents or others", name,
              least);
    cr_expect(strstr(svg, "largest error (m)"), "no axis");
    cr_expect(!strstr(svg, "What accuracy costs"), "a title");
}

Test(paper, figures_are_as_wide_as_a_column_or_a_page, .init = make_tables) {
    plot("column", (const char *const[]){NULL});
    check_sizes("column", 86);
    plot("page", (const char *const[]){NULL});
    check_sizes("page", 178);
    char *orbits = text_of("orbits-30s-column.svg"); /* of five panels, on a page of 297 mm */
    double high = INFINITY;
    sscanf(strstr(orbits, "height=\""), "height=\"%lfmm", &high);
    cr_expect_lt(high, 240, "orbits are %g mm high", high);
    char *png = text_of("radius-page.png");
    const unsigned char *head = (const unsigned char *)png;
    const int wide = head[18] * 256 + head[19];
    cr_expect_float_eq(wide / 300. * 25.4, 178, 0.2, "%d pixels", wide);
}

/* On the screen the second panel has no words on its axis, for the first has them. */
Test(paper, what_is_chosen_is_drawn, .init = make_tables) {
    plot("column", (const char *const[]){"--figure", "work-precision", "--panel", "2", "--methods",
                                         "rk4,midpoint", "--format", "svg", NULL});
    cr_expect_eq(count_files(printed("%s/circle/paper", folder), ""), 1, "more than one file");
    char *svg = text_of("work-precision-column.svg");
    cr_expect(strstr(svg, ">force evaluations<") && strstr(svg, ">largest error (m)<"));
    cr_expect(!strstr(svg, "CPU time"), "the first panel is there");
    cr_expect(strstr(svg, ">rk4") && strstr(svg, ">midpoint"));
    cr_expect(!strstr(svg, ">euler"), "a method that was not chosen");
}

Test(paper, what_is_not_there_is_refused, .init = make_tables) {
    static const struct {
        const char *words[7], *says;
    } wrong[] = {
        {{"--paper", "poster"}, "not one of column, page"},
        {{"--format", "pdf"}, "say --paper column or page"},
        {{"--paper", "page", "--format", "eps"}, "not one of pdf, svg, png"},
        {{"--paper", "page", "--panel", "1,9"},
         "--panel 9: no figure has so many panels: orbits-30s has 5, orbits-160s has 5, "},
        {{"--paper", "page", "--figure", "work-precision", "--panel", "3"},
         "so many panels: work-precision has 2\n"},
        {{"--paper", "page", "--panel", "0"}, "counted from 1"},
        {{"--paper", "page", "--panel", "1,"}, "counted from 1"},
        {{"--paper", "page", "--figure", "none"}, "no figure 'none'; there are orbits-30s, orbits"},
        {{"--paper", "page", "--methods", "none"}, "no table of circle has a row of method 'none'"},
        {{"--paper", "page", "--methods", "rk4,nosuch"}, "of method 'nosuch'; there are "},
        {{"--paper", "page", "--methods", "rk4,nosuch"}, "euler, midpoint"},
        {{"--paper", "page", "--figure", "orbits-30s", "--methods", "rk4 x"},
         "no table of circle/orbits-30s has a row of method 'rk4 x'; there are "},
        {{"--paper", "page", "--methods", "rk4,"}, "names with commas between"},
    };
    const char *const path = printed("%s/circle/paper", folder);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const char *words[20] = {"plot", "circle", "--out", folder};
        for (int k = 0; k < 7 && wrong[i].words[k]; k++)
            words[4 + k] = wrong[i].words[k];
        program_must(NULL, 1, wrong[i].says, words);
        cr_expect_eq(count_files(path, ""), 0, "'%s': something was left", wrong[i].says);
    }
}
