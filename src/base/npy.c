#include "npy.h"

#include <endian.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The magic bytes, the version, and in two bytes how long the header is: a dictionary as Python
 * writes it, filled with spaces so that rows begin at a multiple of 64. */
static const char magic[] = "\x93NUMPY\x01";
enum { MAGIC = 8, PREAMBLE = 10, ALIGNMENT = 64 };

/* Ours has the shape first and wide enough for any number, at a place that does not depend on the
 * names. */
static const char shape[] = "{'shape': (";
#define ROWS "%20lld"

void npy_begin(FILE *stream, const char *const *names) {
    static const char rest[] = ",), 'fortran_order': False, 'descr': [";
    size_t length = sizeof shape - 1 + 20 + sizeof rest - 1 + sizeof "]}\n" - 1;
    for (int i = 0; names[i]; i++)
        length += strlen(names[i]) + sizeof "('', '<f8')," - 1;
    const size_t whole = (PREAMBLE + length + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT - PREAMBLE;
    fwrite(magic, 1, MAGIC, stream);
    fputc((int)(whole & 255), stream);
    fputc((int)(whole >> 8), stream);
    fprintf(stream, "%s" ROWS "%s", shape, 0LL, rest);
    for (int i = 0; names[i]; i++)
        fprintf(stream, "('%s', '<f8'),", names[i]);
    fprintf(stream, "]}%*s\n", (int)(whole - length), "");
}

/* To and from the file's order of bytes: a swap is its own inverse. */
static double little_endian(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits = htole64(bits);
    memcpy(&x, &bits, sizeof bits);
    return x;
}

void npy_put(FILE *stream, const double *number, size_t count) {
    if (htole64(1) == 1) {
        fwrite(number, sizeof *number, count, stream);
        return;
    }
    for (size_t i = 0; i < count; i++) {
        const double x = little_endian(number[i]);
        fwrite(&x, sizeof x, 1, stream);
    }
}

void npy_set_rows(FILE *stream, long long rows) {
    fseek(stream, PREAMBLE + sizeof shape - 1, SEEK_SET);
    fprintf(stream, ROWS, rows);
}

/* The header's text, for free; NULL where there is none. The rows are next. */
static char *read_header(FILE *file) {
    unsigned char preamble[PREAMBLE];
    if (fread(preamble, 1, PREAMBLE, file) != PREAMBLE || memcmp(preamble, magic, MAGIC) != 0)
        return NULL;
    const size_t length = preamble[8] | (size_t)preamble[9] << 8;
    char *text = calloc(length + 1, 1);
    if (text && fread(text, 1, length, file) == length)
        return text;
    free(text);
    return NULL;
}

/* The next column's name in the list of types that `at` is in, ended there; NULL: there is no other
 * one. `at` goes behind it. A type that is no little-endian double makes *sound 0. */
static char *next_name(char **at, int *sound) {
    static const char type[] = "', '<f8')";
    char *begin = strpbrk(*at, "(]");
    if (!begin || *begin == ']')
        return NULL;
    char *end = begin[1] == '\'' ? strchr(begin + 2, '\'') : NULL;
    *sound = end && strncmp(end, type, sizeof type - 1) == 0;
    if (!*sound)
        return NULL;
    *at = end + sizeof type - 1;
    *end = '\0';
    return begin + 2;
}

/* Returns NULL, or what is wrong. */
static const char *read_names(struct table *table, char *header) {
    static const char key[] = "'descr': [";
    char *at = strstr(header, key);
    int sound = at != NULL;
    at = at ? at + sizeof key - 1 : NULL;
    for (char *name; sound && (name = next_name(&at, &sound)) != NULL;) {
        if (table->column_count == TABLE_COLUMNS_MAX)
            return "too many columns";
        table->name[table->column_count] = strdup(name);
        if (!table->name[table->column_count++])
            return "out of memory";
    }
    return sound && table->column_count > 0 ? NULL : "is no array of named columns of <f8";
}

/* The length of an array of one dimension; -1 where it has another shape. */
static long long read_rows(const char *header) {
    static const char key[] = "'shape': (";
    const char *at = strstr(header, key);
    char *end = NULL;
    const long long rows = at ? strtoll(at + sizeof key - 1, &end, 10) : -1;
    return end && (strncmp(end, ",)", 2) == 0) ? rows : -1;
}

static double bytes_left(FILE *file) {
    const long at = ftell(file);
    const int bad = at < 0 || fseek(file, 0, SEEK_END);
    const long end = ftell(file);
    return bad || fseek(file, at, SEEK_SET) ? -1 : (double)(end - at);
}

static const char *read_values(struct table *table, FILE *file, long long rows) {
    const size_t columns = (size_t)table->column_count;
    if (rows < 0 || rows > INT32_MAX)
        return "has no rows of numbers";
    const size_t count = (size_t)rows * columns;
    const double bytes = (double)(count * sizeof *table->value);
    if (bytes_left(file) != bytes) /* before there is room made for them */
        return "has not as many rows as it says";
    table->value = malloc((count + 1) * sizeof *table->value);
    if (!table->value)
        return "out of memory";
    if (fread(table->value, sizeof *table->value, count, file) != count)
        return "cannot be read";
    for (size_t i = 0; i < count; i++)
        table->value[i] = little_endian(table->value[i]);
    table->row_count = (int)rows;
    return NULL;
}

const char *npy_read(struct table *table, FILE *file) {
    char *header = read_header(file);
    if (!header)
        return "has no header of version 1.0";
    const long long rows = read_rows(header);
    const char *wrong = read_names(table, header);
    free(header);
    return wrong ? wrong : read_values(table, file, rows);
}

int npy_is_begun(FILE *file) {
    const int first = fgetc(file);
    if (first != EOF)
        ungetc(first, file);
    return first == (unsigned char)magic[0];
}

int npy_mend(FILE *file) {
    struct table table = {0};
    char *header = read_header(file);
    const char *wrong = header ? read_names(&table, header) : "";
    const long begin = ftell(file), row = (long)sizeof(double) * table.column_count;
    free(header);
    table_free(&table);
    if (wrong || fseek(file, 0, SEEK_END))
        return -1;
    const long rows = (ftell(file) - begin) / row;
    npy_set_rows(file, rows);
    return fflush(file) || ftruncate(fileno(file), begin + rows * row) ? -1 : 0;
}
