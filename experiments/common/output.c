#include "output.h"

#include "run/record.h"

#include <stdlib.h>

int open_table(struct atomic_file *file, const char *folder, const struct table_form *form,
               const struct scene *scene, char *reason) {
    char path[PATH_SIZE];
    if (path_format(path, "%s/%s.tsv", folder, form->name))
        return fail_with(reason, "the path of table %.100s is too long", form->name);
    if (atomic_open(file, path, reason))
        return -1;
    write_provenance(file->stream, form->what, scene);
    columns_write(file->stream, form->columns);
    return 0;
}

FILE *output_table(struct output *output, const char *name, const char *what,
                   const struct scene *scene, const struct column *columns) {
    const size_t count = (size_t)output->table_count + 1;
    struct atomic_file *tables = realloc(output->tables, count * sizeof *tables);
    if (!tables) {
        fail_with(output->reason, "out of memory");
        return NULL;
    }
    output->tables = tables;
    struct atomic_file *table = &tables[output->table_count];
    const struct table_form form = {name, what, columns};
    if (open_table(table, output->folder, &form, scene, output->reason))
        return NULL;
    output->table_count++;
    return table->stream;
}

int output_tables(struct output *output, FILE **streams, const struct table_form *forms, int count,
                  const char *prefix, const struct scene *scene) {
    for (int i = 0; i < count; i++) {
        char name[128];
        snprintf(name, sizeof name, "%s%s", prefix, forms[i].name);
        streams[i] = output_table(output, name, forms[i].what, scene, forms[i].columns);
        if (!streams[i])
            return -1;
    }
    return 0;
}

int output_statements(struct output *output, const struct scene *scene, const char *cut) {
    output->is_stated =
        statements_open(&output->statements, output->folder, scene, cut, output->reason) == 0;
    return output->is_stated ? 0 : -1;
}

int output_close(struct output *output, int code) {
    int failed = code < 0;
    for (int i = 0; i < output->table_count; i++)
        if (failed)
            atomic_discard(&output->tables[i]);
        else
            failed = atomic_commit(&output->tables[i], output->reason) != 0;
    if (output->is_stated)
        failed |= statements_close(&output->statements, failed ? -1 : code, output->reason) < 0;
    free(output->tables);
    output->tables = NULL;
    output->table_count = output->is_stated = 0;
    return failed ? -1 : code;
}
