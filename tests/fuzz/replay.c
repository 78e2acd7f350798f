/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Without libFuzzer: runs the target on every file of the folders given, and on nothing. */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int replay(const char *path)
{
    struct stat info;
    FILE *f = fopen(path, "rb");
    if (!f || fstat(fileno(f), &info) != 0) return -1;
    if (!S_ISREG(info.st_mode)) return fclose(f);
    uint8_t *data = malloc((size_t)info.st_size + 1); /* exact for the sanitizers: no slack read */
    size_t size = data ? fread(data, 1, (size_t)info.st_size, f) : 0;
    fclose(f);
    uint8_t *exact = realloc(data, size ? size : 1);
    LLVMFuzzerTestOneInput(exact ? exact : data, size);
    free(exact ? exact : data);
    return 0;
}

int main(int argc, char **argv)
{
    int files = 0;
    const uint8_t nothing[1] = {0};
    LLVMFuzzerTestOneInput(nothing, 0);
    for (int i = 1; i < argc; i++) {
        DIR *d = opendir(argv[i]);
        if (!d) return fprintf(stderr, "cannot open %s\n", argv[i]), 1;
        for (struct dirent *e; (e = readdir(d)) != NULL;) {
            char path[1024];
            snprintf(path, sizeof path, "%s/%s", argv[i], e->d_name);
            if (e->d_name[0] != '.' && replay(path) == 0) files++;
        }
        closedir(d);
    }
    printf("%d files\n", files);
    return argc > 1 && files == 0;
}
