#include "rodwake/store/generations.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/journal.hpp"

namespace rodwake::store {

namespace fs = std::filesystem;

namespace {

bool is_there(const fs::path& file) {
    std::error_code error;
    return fs::symlink_status(file, error).type() != fs::file_type::not_found;
}

/// Why a file that is there cannot be used; empty if it can.
std::string fault_of(const fs::path& file) {
    try {
        Journal(file).read(0);
        return {};
    } catch (const InputError& error) {
        return error.what();
    }
}

} // namespace

fs::path previous_generation(const fs::path& target) {
    fs::path previous = target;
    return previous += ".previous";
}

void write_generation(const fs::path& target, std::string_view bytes) {
    PendingFile pending(target);
    pending.write(bytes);
    pending.sync();
    std::error_code error;
    if (is_there(target) && fault_of(target).empty())
        fs::rename(target, previous_generation(target), error);
    if (error)
        throw RunError(target.string() +
                       ": cannot keep the last checkpoint as the previous: " + error.message());
    pending.commit();
}

std::optional<Generation> find_generation(const fs::path& target) {
    const fs::path previous = previous_generation(target);
    if (!is_there(target) && !is_there(previous))
        return std::nullopt;
    std::string why = is_there(target) ? fault_of(target) : target.string() + ": is missing";
    if (why.empty())
        return Generation{target, {}};
    if (is_there(previous)) {
        const std::string fault = fault_of(previous);
        if (fault.empty())
            return Generation{previous, why + "; resuming from " + previous.string()};
        why += "; " + fault;
    }
    throw InputError(why + "; no checkpoint can be used: remove the files there to start again");
}

void remove_generations(const fs::path& target) {
    for (const fs::path& file : {target, previous_generation(target)}) {
        std::error_code error;
        if (fs::remove(file, error); error)
            throw RunError(file.string() + ": cannot remove the checkpoint: " + error.message());
    }
}

} // namespace rodwake::store
