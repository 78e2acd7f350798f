/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Worker processes: tasks go down one pipe, results come up another. Messages are smaller
 * than PIPE_BUF, so each is written and read whole. A worker that dies takes nobody along. */
#include "campaign/campaign.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#ifdef __linux__
#include <sys/prctl.h>
#endif

_Static_assert(sizeof(ph_i_record) <= PIPE_BUF, "a result must go through a pipe whole");

/* All of it: 1; nothing there yet: 0; the end of the stream or an error: -1. */
static int read_all(int fd, void *to, size_t n)
{
    char *at = to;
    while (n > 0) {
        ssize_t got = read(fd, at, n);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0 && errno == EAGAIN && at == to) return 0;
        if (got <= 0) return -1;
        at += got;
        n -= (size_t)got;
    }
    return 1;
}

static bool write_all(int fd, const void *from, size_t n)
{
    const char *at = from;
    while (n > 0) {
        ssize_t put = write(fd, at, n);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return false;
        at += put;
        n -= (size_t)put;
    }
    return true;
}

static void close_fd(int *fd)
{
    if (*fd >= 0) close(*fd);
    *fd = -1;
}

/* The life of a worker. It must not hold the ends of the others, nor the lock: what is open
 * here stays open when the parent is gone. */
static void serve(ph_i_pool *p, int me, int from, int to)
{
    ph_i_task task;
    ph_i_record result;
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    signal(SIGINT, SIG_IGN); /* of the terminal: the parent decides */
    signal(SIGTERM, SIG_DFL);
    signal(SIGPIPE, SIG_DFL);
    for (int w = 0; w < p->n; w++)
        if (w != me) {
            close_fd(&p->worker[w].to);
            close_fd(&p->worker[w].from);
        }
    for (int k = 0; k < 2; k++)
        close_fd(&p->keep_out[k]);
    while (read_all(from, &task, sizeof task) > 0) {
        memset(&result, 0, sizeof result);
        result.point = task.point;
        result.i = task.i;
        result.status = p->work(p->user, &task, &result);
        if (!write_all(to, &result, sizeof result)) break;
    }
    _exit(0);
}

static ph_status spawn(ph_i_pool *p, int w, ph_error *err)
{
    ph_status st = PH_OK;
    int down[2] = {-1, -1}, up[2] = {-1, -1};
    PH_CHECK(pipe(down) == 0 && pipe(up) == 0, PH_EIO, "no pipe for a worker: %s",
             strerror(errno));
    fflush(NULL); /* or the child would have it too */
    pid_t pid = fork();
    PH_CHECK(pid >= 0, PH_ENOMEM, "no process for a worker: %s", strerror(errno));
    if (pid == 0) {
        close(down[1]);
        close(up[0]);
        serve(p, w, down[0], up[1]);
    }
    fcntl(up[0], F_SETFL, O_NONBLOCK);
    p->worker[w] = (ph_i_worker){.pid = pid, .to = down[1], .from = up[0]};
    down[1] = up[0] = -1;
out:
    for (int k = 0; k < 2; k++) {
        close_fd(&down[k]);
        close_fd(&up[k]);
    }
    return st;
}

ph_status ph_i_pool_start(ph_i_pool *p, int workers, ph_i_work *work, void *user,
                          const int keep_out[2], ph_error *err)
{
    ph_status st = PH_OK;
    *p = (ph_i_pool){.work = work, .user = user, .keep_out = {keep_out[0], keep_out[1]}};
    PH_ALLOC(p->worker, workers, "the workers");
    for (int w = 0; w < workers; w++)
        p->worker[w] = (ph_i_worker){.to = -1, .from = -1};
    p->n = workers;
    for (int w = 0; w < workers; w++)
        PH_TRY(spawn(p, w, err));
out:
    if (st != PH_OK) ph_i_pool_stop(p);
    return st;
}

bool ph_i_pool_send(ph_i_pool *p, int w, const ph_i_task *task, int n)
{
    ph_i_worker *worker = &p->worker[w];
    if (worker->pid == 0 || worker->count + n > PH_I_QUEUE) return false;
    if (!write_all(worker->to, task, sizeof *task * (size_t)n)) return false;
    for (int k = 0; k < n; k++)
        worker->queue[(worker->first + worker->count++) % PH_I_QUEUE] = task[k];
    return true;
}

/* Nothing more will come from this worker: what did it die of? */
static void bury(ph_i_worker *worker, char *how, size_t size)
{
    int status = 0;
    kill((pid_t)worker->pid, SIGKILL);
    while (waitpid((pid_t)worker->pid, &status, 0) < 0 && errno == EINTR)
        ;
    if (WIFSIGNALED(status))
        snprintf(how, size, "its worker process was ended by signal %d%s",
                 WTERMSIG(status),
                 WTERMSIG(status) == SIGKILL ? " (out of memory?)" : "");
    else
        snprintf(how, size, "its worker process ended with code %d", WEXITSTATUS(status));
    worker->pid = 0;
    close_fd(&worker->to);
    close_fd(&worker->from);
}

/* What a worker has for us, as ph_i_pool_wait returns it. */
static int take(ph_i_pool *p, int worker, ph_i_record *out, char *how, size_t size)
{
    ph_i_worker *w = &p->worker[worker];
    int got = read_all(w->from, out, sizeof *out);
    if (got > 0) {
        w->first = (w->first + 1) % PH_I_QUEUE;
        w->count--;
        return 1;
    }
    if (got == 0) return 0;
    bury(w, how, size);
    return 2;
}

int ph_i_pool_wait(ph_i_pool *p, double seconds, int *worker, ph_i_record *out, char *how,
                   size_t size)
{
    struct pollfd fds[PH_I_WORKERS];
    int at[PH_I_WORKERS], n = 0, what = 0;
    if (p->worker[p->last].pid != 0) { /* it may have more */
        *worker = p->last;
        what = take(p, p->last, out, how, size);
        if (what) return what;
    }
    for (int w = 0; w < p->n; w++)
        if (p->worker[w].pid != 0) {
            fds[n] = (struct pollfd){.fd = p->worker[w].from, .events = POLLIN};
            at[n++] = w;
        }
    if (poll(fds, (nfds_t)n, (int)(1e3 * seconds)) <= 0) return 0;
    for (int k = 0; k < n && what == 0; k++) {
        if (!(fds[k].revents & (POLLIN | POLLHUP | POLLERR))) continue;
        *worker = p->last = at[k];
        what = take(p, at[k], out, how, size);
    }
    return what;
}

ph_status ph_i_pool_renew(ph_i_pool *p, int worker, ph_error *err)
{
    p->worker[worker] = (ph_i_worker){.to = -1, .from = -1};
    return spawn(p, worker, err);
}

void ph_i_pool_stop(ph_i_pool *p)
{
    char how[128];
    for (int w = 0; w < p->n; w++)
        if (p->worker[w].pid != 0) bury(&p->worker[w], how, sizeof how);
    free(p->worker);
    p->worker = NULL;
    p->n = 0;
}
