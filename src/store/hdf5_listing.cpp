#include "rodwake/store/hdf5_reader.hpp"

#include "hdf5_file.hpp"
#include "hdf5_input.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <optional>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace rodwake::store {

namespace {

constexpr rlim_t most_memory = 800'000'000; // beyond what the parent had
bool is_child = false; ///< this process was forked to look into a file, and may die of it

/// A file that asks for more memory than any of ours is damaged: dying says so.
void die_without_memory() {
    const auto lacks = [](unsigned, const H5E_error2_t* error, void* found) -> herr_t {
        *static_cast<bool*>(found) |= error->maj_num == H5E_RESOURCE;
        return 0;
    };
    bool found = false;
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, lacks, &found);
    if (is_child && found)
        ::_exit(1);
}

std::string attribute_value(hid_t attribute) {
    const Hdf5Handle type(H5Aget_type(attribute), H5Tclose, "read an attribute's type");
    const Hdf5Handle space(H5Aget_space(attribute), H5Sclose, "read an attribute's shape");
    const hssize_t count = H5Sget_simple_extent_npoints(space.get());
    if (H5Tget_class(type.get()) == H5T_STRING && count >= 0) {
        // One string, or several as a list.
        const auto strings = static_cast<std::size_t>(count);
        if (H5Tis_variable_str(type.get()) > 0) {
            std::vector<char*> rows(is_child ? strings : 0, nullptr); // the reader will follow its pointers
            if (!rows.empty() && H5Aread(attribute, type.get(), rows.data()) < 0)
                die_without_memory();
            return "(variable-length string)";
        }
        const std::size_t size = H5Tget_size(type.get());
        std::string table(size * strings, '\0');
        if (H5Aread(attribute, type.get(), table.data()) < 0)
            throw RunError("HDF5: cannot read an attribute");
        std::vector<std::string> values;
        for (std::size_t i = 0; i < strings; ++i)
            values.push_back(fmt::format("\"{}\"", std::string(table.substr(i * size, size).c_str())));
        return fmt::format("{}", fmt::join(values, ", "));
    }
    if (count != 1)
        return "(array)";
    double value = 0.0;
    H5Aread(attribute, H5T_NATIVE_DOUBLE, &value);
    return fmt::format("{}", value);
}

/// An exception must not cross HDF5's C code: it becomes the iteration's failure code.
template<class Work>
herr_t guarded(Work work) {
    try {
        work();
        return 0;
    } catch (const std::bad_alloc&) {
        if (is_child)
            ::_exit(1);
        return -1;
    } catch (...) {
        return -1;
    }
}

herr_t append_attribute(hid_t object, const char* name, const H5A_info_t*, void* text) {
    if (std::string_view(name) == checksum_name)
        return 0;
    return guarded([&] {
        const Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, "open an attribute");
        *static_cast<std::string*>(text) += fmt::format("  {} = {}", name, attribute_value(attribute.get()));
    });
}

/// As the reader will: a crash, or a loop without end, happens here first. What cannot be read the reader
/// tells better.
void touch_rows(hid_t dataset) {
    const Hdf5Handle stored(H5Dget_type(dataset), H5Tclose, "read a dataset's type");
    const H5T_class_t kind = H5Tget_class(stored.get());
    std::vector<hsize_t> extent = extent_of(dataset);
    if ((kind != H5T_INTEGER && kind != H5T_FLOAT && kind != H5T_ENUM) || extent.empty() || extent[0] == 0)
        return;
    const hsize_t last = std::exchange(extent[0], 1) - 1;
    double size = static_cast<double>(H5Tget_size(stored.get()));
    for (const hsize_t side : extent)
        size *= static_cast<double>(side);
    if (size > static_cast<double>(most_memory))
        ::_exit(1);
    std::vector<std::byte> row(static_cast<std::size_t>(size));
    for (const hsize_t at : {hsize_t{0}, last})
        if (!read_rows(dataset, stored.get(), at, 1, row.data()))
            die_without_memory();
}

/// Looks into the index of chunks, too: it may be damaged.
std::string shape_of(hid_t dataset) {
    const Hdf5Handle made(H5Dget_create_plist(dataset), H5Pclose, "read about a dataset");
    const Hdf5Handle space(H5Dget_space(dataset), H5Sclose, "read a dataset's shape");
    hsize_t chunks = 0;
    if (H5Pget_layout(made.get()) == H5D_CHUNKED && H5Dget_num_chunks(dataset, space.get(), &chunks) < 0)
        throw RunError("HDF5: cannot read chunks");
    if (is_child && H5Pget_layout(made.get()) != H5D_VIRTUAL && H5Pget_external_count(made.get()) == 0)
        touch_rows(dataset);
    return fmt::format("[{}]", fmt::join(extent_of(dataset), "]["));
}

herr_t append_object(hid_t root, const char* name, const H5O_info_t* info, void* text) {
    return guarded([&] {
        auto& out = *static_cast<std::string*>(text);
        const Hdf5Handle object(H5Oopen(root, name, H5P_DEFAULT), H5Oclose, "open an object");
        out += std::string_view(name) == "." ? "/" : std::string("/") + name;
        if (info->type == H5O_TYPE_DATASET)
            out += " " + shape_of(object.get());
        hsize_t start = 0;
        if (H5Aiterate2(object.get(), H5_INDEX_NAME, H5_ITER_INC, &start, append_attribute, &out) < 0)
            throw RunError("HDF5: cannot read attributes");
        out += "\n";
    });
}

/// The guard is the caller's: in a forked child it is held for ever.
std::string listing(const std::filesystem::path& path) {
    set_up_hdf5();
    const hid_t id = open_for_reading(path);
    if (id < 0)
        throw InputError(path.string() + ": not a readable HDF5 file");
    const Hdf5Handle file(id, H5Fclose, "open " + path.string());
    std::string text;
    if (H5Ovisit2(file.get(), H5_INDEX_NAME, H5_ITER_INC, append_object, &text, H5O_INFO_BASIC) < 0)
        throw InputError(path.string() + ": the HDF5 file is damaged");
    return text;
}

// What the child process says: that HDF5 lets it in, then an answer that begins with one of two and ends with
// `whole`.
constexpr char let_in = '!', listed = '+', refused = '-', whole = '.';

[[noreturn]] void answer(const std::filesystem::path& path, int to) {
    constexpr unsigned longest = 15; // s; a large file takes some tenths of one
    is_child = true;
    // A crash of the child is an answer: handlers of the parent (of a test, of Python) would report it as
    // theirs.
    for (const int crash : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
        std::signal(crash, SIG_DFL);
    const rlimit none{0, 0};
    ::setrlimit(RLIMIT_CORE, &none);
    rlim_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages >> pages >> pages >> pages >> pages >> pages; // the last: data
    const rlim_t memory = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + most_memory;
    const rlimit enough{memory, memory};
    if (pages > 0)
        ::setrlimit(RLIMIT_DATA, &enough);
    ::alarm(longest);
    try {
        set_up_hdf5();
        write_all(to, std::string(1, let_in), path);
        std::string text;
        try {
            text = listed + listing(path);
        } catch (const std::exception& error) {
            text = refused + std::string(error.what());
        }
        write_all(to, text + whole, path);
    } catch (const std::exception&) { // nobody listens any more
    }
    ::_exit(0);
}

/// What a child process says of the file: it may crash there. Empty if it did; none if there can be no child,
/// or it is not let in.
std::optional<std::string> asked_of_child(const std::filesystem::path& path) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0)
        return std::nullopt;
    const pid_t child = ::fork();
    if (child == 0)
        answer(path, ends[1]);
    ::close(ends[1]);
    // Whether the child is let in. It is not if some library of this process (h5py) was inside HDF5 as it was
    // forked.
    constexpr int longest = 3000; // ms
    pollfd waiting{ends[0], POLLIN, 0};
    char said = 0;
    while (::poll(&waiting, 1, longest) < 0 && errno == EINTR) {
    }
    const bool asked =
        child > 0 && (waiting.revents & POLLIN) != 0 && ::read(ends[0], &said, 1) == 1 && said == let_in;
    std::string text;
    std::array<char, 4096> some{};
    for (ssize_t got = 0; asked && (got = ::read(ends[0], some.data(), some.size())) != 0;) {
        if (got < 0 && errno != EINTR)
            break;
        text.append(some.data(), got < 0 ? 0 : static_cast<std::size_t>(got));
    }
    ::close(ends[0]);
    if (child > 0 && !asked)
        ::kill(child, SIGKILL);
    while (child > 0 && ::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
    }
    if (!asked)
        return std::nullopt;
    if (!text.ends_with(whole) || text.size() < 2)
        return "";
    text.pop_back();
    return text;
}

} // namespace

bool hdf5_survives(const std::filesystem::path& path) {
    const Hdf5Guard guard;
    return asked_of_child(path) != "";
}

std::string list_hdf5(const std::filesystem::path& path) {
    const Hdf5Guard guard;
    const std::optional<std::string> answer = asked_of_child(path);
    if (!answer)
        return listing(path);
    if (answer->empty())
        throw InputError(path.string() + ": the HDF5 file is damaged: the HDF5 library crashes on it");
    if (answer->front() == refused)
        throw InputError(answer->substr(1));
    return answer->substr(1);
}

} // namespace rodwake::store
