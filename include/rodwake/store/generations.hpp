#pragma once
// The last two checkpoints of a run, "<target>" and "<target>.previous": at every instant at least one of
// them is whole.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace rodwake::store {

std::filesystem::path previous_generation(const std::filesystem::path& target);

/// Makes `bytes` (of journal_of) the newest generation: written under a temporary name, synced; the newest
/// so far becomes the previous one (if it is whole; a damaged one is replaced instead); renamed into place,
/// folder synced. Throws RunError with the system's reason; the generations are then as they were, or the
/// newest so far is found as the previous.
void write_generation(const std::filesystem::path& target, std::string_view bytes);

struct Generation {
    std::filesystem::path file;
    std::string notice; ///< why the newest cannot be used; empty if it is this
};

/// The newest generation that is whole; nothing if neither file is there. Throws InputError with the reasons
/// if none is whole.
std::optional<Generation> find_generation(const std::filesystem::path& target);

/// Removes both. Throws RunError.
void remove_generations(const std::filesystem::path& target);

} // namespace rodwake::store
