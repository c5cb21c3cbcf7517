/* Tables of results: as numbers and as texts, checked for gaps, and on a page. */
#include "base/table.h"

#include "base/text_table.h"
#include "fuzz.h"
#include "report/html.h"

#include <stdio.h>
#include <stdlib.h>

static void show(const struct text_table *table) {
    char *page = NULL;
    size_t size;
    FILE *stream = open_memstream(&page, &size);
    html_table(stream, table, NULL);
    html_text(stream, table->about);
    for (int row = 0; row < table->row_count; row++)
        html_statement(stream, table, row);
    fclose(stream);
    free(page);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char reason[REASON_SIZE] = "";
    struct table numbers;
    struct text_table texts;
    const char *path = fuzz_file("table.tsv", data, size);
    if (table_read(&numbers, path, reason)) {
        fuzz_refusal(reason);
    } else {
        const int column = table_column(&numbers, "error");
        for (int row = 0; column >= 0 && row < numbers.row_count; row++)
            table_value(&numbers, row, column);
        table_free(&numbers);
    }
    if (text_table_read(&texts, path, reason)) {
        fuzz_refusal(reason);
        return 0;
    }
    if (text_table_check(&texts, path, reason))
        fuzz_refusal(reason);
    for (int row = 0; row < texts.row_count; row++)
        text_table_number(&texts, row, "error");
    show(&texts);
    text_table_free(&texts);
    return 0;
}
