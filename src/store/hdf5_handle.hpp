#pragma once
// RAII over HDF5's C handles.

#include "rodwake/core/error.hpp"

#include <hdf5.h>

#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace rodwake::store {

/// Before the first use of HDF5 by a thread. Failures are reported by us, not printed by the library. And it
/// must not clean up at exit: a file it could not flush (full disk) would crash it there. Throws RunError if
/// it has not memory enough to begin: any other call of its would then crash.
inline void set_up_hdf5() {
    [[maybe_unused]] static const herr_t once = H5dont_atexit();
    if (H5open() < 0)
        throw RunError("HDF5 cannot begin: not enough memory");
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

/// Held by whoever calls HDF5, from any thread: a library that was built without thread safety lets one in at
/// a time. One that was built with it does so, too, by a lock of its own; but a process that is forked while
/// a thread is inside (hdf5_survives) would wait for that lock for ever.
class Hdf5Guard {
public:
    Hdf5Guard() : lock_(mutex()) {}

private:
    static std::recursive_mutex& mutex() {
        static std::recursive_mutex item;
        return item;
    }
    std::unique_lock<std::recursive_mutex> lock_;
};

/// ": <what the system said>" if the last HDF5 call failed for a reason of the system's, else empty.
std::string hdf5_reason();

class Hdf5Handle {
public:
    using Close = herr_t (*)(hid_t);
    /// Throws RunError saying what could not be done, and why, if the handle is not valid.
    Hdf5Handle(hid_t id, Close closing, const std::string& doing) : id_(id), close_(closing) {
        if (id_ < 0)
            throw RunError("HDF5: cannot " + doing + hdf5_reason());
    }
    ~Hdf5Handle() {
        if (id_ >= 0)
            close_(id_);
    }
    /// Of what was written: with this call goes what the library still held of it. Throws RunError.
    void close(const std::string& doing) {
        if (close_(std::exchange(id_, -1)) < 0)
            throw RunError("HDF5: cannot " + doing + hdf5_reason());
    }
    Hdf5Handle(const Hdf5Handle&) = delete;
    Hdf5Handle& operator=(const Hdf5Handle&) = delete;
    Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    Hdf5Handle& operator=(Hdf5Handle&&) = delete;
    hid_t get() const { return id_; }

private:
    hid_t id_;
    Close close_;
};

/// Extents of a dataset; none of a scalar.
std::vector<hsize_t> extent_of(hid_t dataset);

/// Rows of a dataset, which is read whole if it is a scalar, into `values`; false if HDF5 cannot.
bool read_rows(hid_t dataset, hid_t type, hsize_t first, hsize_t count, void* values);

} // namespace rodwake::store
