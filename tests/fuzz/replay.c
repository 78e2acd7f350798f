/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Without libFuzzer: run a fuzz target over every file of the folders given. */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MAX_INPUT = 1 << 20 };

static int replay_file(const char *path, uint8_t *buffer)
{
    FILE *file = fopen(path, "rb");
    if (!file) return 1;
    size_t size = fread(buffer, 1, MAX_INPUT, file);
    fclose(file);
    fprintf(stderr, "%s\n", path); /* the last line names the one that crashed */
    return LLVMFuzzerTestOneInput(buffer, size);
}

static int replay_folder(const char *folder, uint8_t *buffer, long *files)
{
    DIR *all = opendir(folder);
    int failed = all == NULL;
    for (struct dirent *entry; all && (entry = readdir(all));) {
        char path[4096];
        if (entry->d_name[0] == '.') continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        failed |= replay_file(path, buffer);
        ++*files;
    }
    if (all) closedir(all);
    return failed;
}

int main(int argc, char **argv)
{
    uint8_t *buffer = malloc(MAX_INPUT);
    long files = 0;
    int failed = buffer == NULL;
    for (int i = 1; i < argc && buffer; i++)
        failed |= replay_folder(argv[i], buffer, &files);
    free(buffer);
    fprintf(stderr, "%ld files\n", files);
    return failed || files == 0;
}
