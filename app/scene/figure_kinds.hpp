#pragma once
// The kinds of [[figures]]: each stands here once, with what it shows, what it needs and which keys mean
// something for it. Checks, the reference, schema.json and the plots (one module a kind, of the same name) go
// by this list.

#include "rodwake/scene/scene.hpp"

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rodwake::scene {

/// What a figure needs of its scene; `text` ends the message "a figure of kind x needs ...".
struct FigureNeed {
    std::string_view text;
    bool (*is_met)(const Scene&, const Figure&);
};

/// Whose results a figure shows. The window of a figure is in metres for bed and measure, in the profiles'
/// unit for fit, in that of its axes for scan.
enum class FigureSubject { bed, measure, theory, rod_order, fit, scan };
std::string_view to_string(FigureSubject subject);

struct FigureKind {
    std::string name, meaning;
    FigureSubject subject;
    std::vector<FigureNeed> needs;  ///< in order: the first that is not met is reported
    std::vector<std::string> files; ///< of the run directory: what it is drawn from
    std::vector<std::string> keys;  ///< of [[figures]], besides name, kind and title
    /// Values of `quantity` and what each needs besides; kind series alone has any.
    std::vector<std::pair<std::string, FigureNeed>> quantities{};
};

/// In the order of reports.
const std::vector<FigureKind>& figure_kinds();
/// Nothing for a name that is no kind.
const FigureKind* find_figure_kind(const std::string& name);
std::span<const std::string_view> figure_kind_names();
/// Of `quantity`, in any kind.
std::span<const std::string_view> figure_quantities();

/// Whether the figure's kind has the key of this name.
bool has_key(const Figure& figure, std::string_view key);
/// Whether it is of this subject.
bool shows(const Figure& figure, FigureSubject subject);
/// Names of the kinds that have this key.
std::vector<std::string> kinds_with(std::string_view key);

} // namespace rodwake::scene
