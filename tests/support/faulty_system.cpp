// A system on which one call fails: a library to be preloaded into the program under test (faults.py).
//
//   FAULT_CALL   write | fsync | rename | open | unlink | malloc | lock (flock, and fcntl that locks)
//   FAULT_AT     the number of the call that fails, from 1; 0: none; -1: all of them
//   FAULT_ERRNO  what it fails with; -1: half of a write comes through, and the next one fails with ENOSPC
//   FAULT_UNDER  folder: only calls on files in it count (malloc: after the first, not HDF5's)
//   FAULT_LEAST  bytes: only allocations of so many and more count; otherwise of 1 kB, which fail in practice
//   FAULT_IN     name of the program in which calls count
//   FAULT_COUNTS file to which, at the end, the number of calls of each kind is written

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <string_view>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

extern "C" void* __libc_malloc(std::size_t size);

namespace {

enum Call { call_write, call_fsync, call_rename, call_open, call_unlink, call_malloc, call_lock, calls };
constexpr std::array<const char*, calls> names = {"write",  "fsync",  "rename", "open",
                                                  "unlink", "malloc", "lock"};

/// Plain, for it is asked before constructors have run.
struct Plan {
    bool here = false;
    int call = -1, error = 0;
    long at = 0;
    std::size_t least = 1024;
    char under[512] = {};
};

Plan plan;
std::atomic<bool> ready{false}, begun{false}, half_done{false};
std::array<std::atomic<long>, calls> counted{};

const char* setting(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

__attribute__((constructor)) void read_plan() {
    plan.here = std::string_view(setting("FAULT_IN")) == program_invocation_short_name;
    for (int k = 0; k < calls; ++k)
        if (std::string_view(setting("FAULT_CALL")) == names[static_cast<std::size_t>(k)])
            plan.call = k;
    plan.at = std::atol(setting("FAULT_AT"));
    plan.error = std::atoi(setting("FAULT_ERRNO"));
    if (*setting("FAULT_LEAST"))
        plan.least = std::strtoul(setting("FAULT_LEAST"), nullptr, 10);
    std::snprintf(plan.under, sizeof plan.under, "%s", setting("FAULT_UNDER"));
    ready = true;
}

__attribute__((destructor)) void write_counts() {
    if (!plan.here || !*setting("FAULT_COUNTS"))
        return;
    ready = false;
    if (std::FILE* file = std::fopen(setting("FAULT_COUNTS"), "w")) {
        for (std::size_t k = 0; k < calls; ++k)
            std::fprintf(file, "%s %ld\n", names[k], counted[k].load());
        std::fclose(file);
    }
}

bool is_under(const char* path) {
    char whole[4096];
    if (path[0] != '/' && ::getcwd(whole, sizeof whole - 1)) {
        std::strncat(whole, "/", sizeof whole - std::strlen(whole) - 1);
        std::strncat(whole, path, sizeof whole - std::strlen(whole) - 1);
        path = whole;
    }
    return std::strncmp(path, plan.under, std::strlen(plan.under)) == 0;
}

bool is_under(int file) {
    char link[64], path[4096];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t size = ::readlink(link, path, sizeof path - 1);
    path[size > 0 ? size : 0] = '\0';
    return is_under(path);
}

/// Counts the call; whether it is the one to fail, with errno set.
bool fails(Call call) {
    if (call != call_malloc)
        begun = true;
    const long number = ++counted[static_cast<std::size_t>(call)];
    if (plan.call != call || (number != plan.at && plan.at != -1))
        return false;
    errno = plan.error;
    return true;
}

template<class File>
bool fails(Call call, File file) {
    return ready && plan.here && is_under(file) && fails(call);
}

template<class Function>
Function next(const char* name) {
    return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

/// What of a write of this size is to be done; -1: it fails, with errno set.
ssize_t part(int file, std::size_t size) {
    if (half_done && ready && plan.here && is_under(file)) {
        half_done = false;
        errno = ENOSPC;
        return -1;
    }
    if (!fails(call_write, file))
        return static_cast<ssize_t>(size);
    if (plan.error != -1)
        return -1;
    half_done = true;
    return static_cast<ssize_t>((size + 1) / 2);
}

bool creates(int flags) { return (flags & (O_WRONLY | O_RDWR | O_CREAT)) != 0; }

/// HDF5 1.10 frees twice, and crashes, where some of its own small lists find no memory (H5P_close, H5FL).
bool of_hdf5(const void* caller) {
    Dl_info library;
    return dladdr(caller, &library) != 0 && std::strstr(library.dli_fname, "libhdf5") != nullptr;
}

} // namespace

extern "C" {

ssize_t write(int file, const void* bytes, std::size_t size) {
    static const auto real = next<ssize_t (*)(int, const void*, std::size_t)>("write");
    const ssize_t now = part(file, size);
    return now < 0 ? -1 : real(file, bytes, static_cast<std::size_t>(now));
}

ssize_t pwrite64(int file, const void* bytes, std::size_t size, off64_t place) {
    static const auto real = next<ssize_t (*)(int, const void*, std::size_t, off64_t)>("pwrite64");
    const ssize_t now = part(file, size);
    return now < 0 ? -1 : real(file, bytes, static_cast<std::size_t>(now), place);
}

ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t place) {
    return pwrite64(file, bytes, size, place);
}

ssize_t writev(int file, const iovec* parts, int count) {
    static const auto real = next<ssize_t (*)(int, const iovec*, int)>("writev");
    if (fails(call_write, file)) {
        errno = plan.error == -1 ? ENOSPC : plan.error;
        return -1;
    }
    return real(file, parts, count);
}

int fsync(int file) {
    static const auto real = next<int (*)(int)>("fsync");
    return fails(call_fsync, file) ? -1 : real(file);
}

int fdatasync(int file) {
    static const auto real = next<int (*)(int)>("fdatasync");
    return fails(call_fsync, file) ? -1 : real(file);
}

int flock(int file, int operation) {
    static const auto real = next<int (*)(int, int)>("flock");
    return fails(call_lock, file) ? -1 : real(file, operation);
}

int fcntl64(int file, int command, ...) {
    static const auto real = next<int (*)(int, int, ...)>("fcntl64");
    std::va_list rest;
    va_start(rest, command);
    void* argument = va_arg(rest, void*);
    va_end(rest);
    const bool locks = command == F_SETLK || command == F_SETLKW || command == F_GETLK;
    return locks && fails(call_lock, file) ? -1 : real(file, command, argument);
}

int fcntl(int file, int command, ...) {
    std::va_list rest;
    va_start(rest, command);
    void* argument = va_arg(rest, void*);
    va_end(rest);
    return fcntl64(file, command, argument);
}

int rename(const char* from, const char* to) {
    static const auto real = next<int (*)(const char*, const char*)>("rename");
    return fails(call_rename, to) ? -1 : real(from, to);
}

int unlink(const char* path) {
    static const auto real = next<int (*)(const char*)>("unlink");
    return fails(call_unlink, path) ? -1 : real(path);
}

int remove(const char* path) {
    static const auto real = next<int (*)(const char*)>("remove");
    return fails(call_unlink, path) ? -1 : real(path);
}

int open64(const char* path, int flags, ...) {
    static const auto real = next<int (*)(const char*, int, ...)>("open64");
    std::va_list rest;
    va_start(rest, flags);
    const mode_t mode = (flags & O_CREAT) ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    return creates(flags) && fails(call_open, path) ? -1 : real(path, flags, mode);
}

int open(const char* path, int flags, ...) {
    std::va_list rest;
    va_start(rest, flags);
    const mode_t mode = (flags & O_CREAT) ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    return open64(path, flags, mode);
}

std::FILE* fopen64(const char* path, const char* how) {
    static const auto real = next<std::FILE* (*)(const char*, const char*)>("fopen64");
    return how[0] != 'r' && fails(call_open, path) ? nullptr : real(path, how);
}

std::FILE* fopen(const char* path, const char* how) { return fopen64(path, how); }

void* malloc(std::size_t size) {
    if (ready && size >= plan.least && begun && plan.here && !of_hdf5(__builtin_return_address(0)) &&
        fails(call_malloc)) {
        errno = ENOMEM;
        return nullptr;
    }
    return __libc_malloc(size);
}

} // extern "C"
