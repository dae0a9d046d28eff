#include "rodwake/store/generations.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"

#include "descriptor.hpp"

namespace rodwake::store {

namespace fs = std::filesystem;

namespace {

/// A generation that was looked for: whole (blocks), damaged (reason), or not there (neither).
struct Attempt {
    std::optional<std::vector<Block>> blocks;
    std::string reason;
};

Attempt attempt(const fs::path& file) {
    std::error_code error;
    if (fs::symlink_status(file, error).type() == fs::file_type::not_found)
        return {};
    try {
        return {decode_blocks(read_file(file), file.string()), {}};
    } catch (const InputError& reason) {
        return {std::nullopt, reason.what()};
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
    if (attempt(target).blocks)
        fs::rename(target, previous_generation(target), error);
    if (error)
        throw RunError(target.string() +
                       ": cannot keep the last checkpoint as the previous: " + error.message());
    pending.commit();
}

std::optional<LoadedGeneration> load_generation(const fs::path& target) {
    const fs::path previous = previous_generation(target);
    Attempt newest = attempt(target);
    if (newest.blocks)
        return LoadedGeneration{std::move(*newest.blocks), target, {}};
    Attempt older = attempt(previous);
    const std::string why = newest.reason.empty() ? target.string() + ": is missing" : newest.reason;
    if (older.blocks)
        return LoadedGeneration{std::move(*older.blocks), previous,
                                why + "; resuming from " + previous.string()};
    if (newest.reason.empty() && older.reason.empty())
        return std::nullopt;
    throw InputError(why + (older.reason.empty() ? "" : "; " + older.reason) +
                     "; no checkpoint can be used: remove the files there to start again");
}

void remove_generations(const fs::path& target) {
    for (const fs::path& file : {target, previous_generation(target)}) {
        std::error_code error;
        if (fs::remove(file, error); error)
            throw RunError(file.string() + ": cannot remove the checkpoint: " + error.message());
    }
}

} // namespace rodwake::store
