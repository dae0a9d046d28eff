// Tracks from CSV in one pass: blocks of the file, no copy of a cell.

#include "text_lines.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/spelling.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/track_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace rodwake::store {

namespace {

/// What a row says of a particle.
enum ColumnRole : std::size_t {
    frame,
    id,
    x,
    y,
    heading,
    kind,
    radius,
    time,
    thin_x,
    thin_y,
    thick_x,
    thick_y,
    roles
};

struct RoleNames {
    const char* key; ///< of tracks.columns
    std::string TrackColumns::*given;
    std::array<std::string_view, 5> usual; ///< the first that is there, whatever the case of its letters
    bool needed;
};
constexpr RoleNames role_names[roles] = {
    {"frame", &TrackColumns::frame, {"frame", "frame_number", "slice"}, true},
    {"id", &TrackColumns::id, {"particle", "track_id", "trackid", "track", "id"}, false},
    {"x", &TrackColumns::x, {"x", "position_x"}, true},
    {"y", &TrackColumns::y, {"y", "position_y"}, true},
    {"heading", &TrackColumns::heading, {"theta", "heading"}, false},
    {"kind", &TrackColumns::kind, {"kind"}, false},
    {"radius", &TrackColumns::radius, {}, false},
    {"time", &TrackColumns::time, {}, false},
    {"ends", nullptr, {}, false},
    {"ends", nullptr, {}, false},
    {"ends", nullptr, {}, false},
    {"ends", nullptr, {}, false}};

constexpr std::size_t no_column = static_cast<std::size_t>(-1);

struct ColumnRoles {
    std::array<std::size_t, roles> at{};   ///< which column has it
    std::vector<std::uint8_t> role_of;     ///< of the columns up to the last that is used
    std::array<std::string, roles> name{}; ///< as in the file
    bool of_trackmate = false;             ///< three more header lines
};

bool begins_a_number(std::string_view cell) {
    return !cell.empty() &&
           ((cell[0] >= '0' && cell[0] <= '9') || cell[0] == '-' || cell[0] == '+' || cell[0] == '.');
}

class CsvTracks {
public:
    CsvTracks(const std::filesystem::path& path, const TrackColumns& columns)
        : path_(path.string()), given_(columns), lines_(path) {}

    TrackRows read(const TrackProgress& on_progress) {
        if (given_.own_times)
            throw InputError(path_ + ": no rate of the film is given: set tracks.frames_per_second, or "
                                     "tracks.time_column if the file has a column of times in s");
        read_header();
        std::string_view line;
        constexpr std::size_t some = 65536; // rows between two reports
        while (lines_.next_record(line)) {
            row(line);
            if (rows_.size() % some == 1 && !on_progress(lines_.part()))
                break;
        }
        if (rows_.size() == 0)
            throw InputError(
                fmt::format("{}: has no row with a position: x and y of all {} rows are empty or "
                            "not numbers",
                            path_, rows_.without_place));
        return std::move(rows_);
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}:{}: {}", path_, lines_.number(), what));
    }

    void read_header() {
        std::string_view line;
        if (!lines_.next_record(line))
            throw InputError(path_ + ": is empty; expected a header line such as frame,particle,x,y");
        std::vector<std::string> names;
        fields_ = lines_.for_each_cell(line, no_column, [&](std::size_t, std::string_view cell, std::size_t) {
            names.push_back(text_in(cell));
        });
        if (std::ranges::all_of(names, [](const std::string& n) { return number_in(n).has_value(); }))
            fail("the first line holds numbers and no names; put a line such as frame,particle,x,y before "
                 "it");
        columns_.at.fill(no_column);
        guess_ends(names);
        for (std::size_t role = 0; role < roles; ++role)
            find(static_cast<ColumnRole>(role), names);
        const bool named =
            columns_.at[kind] != no_column &&
            std::ranges::none_of(given_.kinds, [](const NamedRadius& of) { return of.names.empty(); });
        if (!given_.kinds.empty() && columns_.at[radius] == no_column && !named)
            fail("tracks.bead_kinds need a column of radii, named in tracks.columns = { radius = \"...\" }, "
                 "or "
                 "a column of kinds and names of each kind");
        std::size_t last = 0;
        for (const std::size_t at : columns_.at)
            last = at == no_column ? last : std::max(last, at);
        columns_.role_of.assign(last + 1, roles);
        for (std::size_t role = 0; role < roles; ++role)
            if (columns_.at[role] != no_column)
                columns_.role_of[columns_.at[role]] = static_cast<std::uint8_t>(role);
        columns_.of_trackmate = std::ranges::find(names, "POSITION_X") != names.end();
    }

    /// Rods that have nothing but two ends.
    void guess_ends(const std::vector<std::string>& names) {
        const auto called = [&](std::string_view name) {
            return std::ranges::find_if(names, [&](const std::string& n) { return alike(n, name); });
        };
        for (const ColumnRole role : {x, y, heading})
            if (!(given_.*role_names[role].given).empty() ||
                std::ranges::any_of(role_names[role].usual, [&](std::string_view usual) {
                    return !usual.empty() && called(usual) != names.end();
                }))
                return;
        std::vector<std::string> ends;
        for (const std::string_view name : {"x1", "y1", "x2", "y2"})
            if (const auto found = called(name); found != names.end())
                ends.push_back(*found);
        if (!given_.ends.empty() || ends.size() < 4)
            return;
        rows_.warnings.push_back(fmt::format("columns {} are taken for the ends of a rod, the thin end first",
                                             fmt::join(ends, ", ")));
        given_.ends = std::move(ends);
    }

    void find(ColumnRole role, const std::vector<std::string>& names) {
        const RoleNames& of = role_names[role];
        const std::string given = of.given              ? given_.*of.given
                                  : given_.ends.empty() ? ""
                                                        : given_.ends.at(role - thin_x);
        const auto take = [&](std::string_view wanted, bool exactly) {
            const auto is_it = [&](const std::string& n) { return exactly ? n == wanted : alike(n, wanted); };
            const auto found = std::ranges::find_if(names, is_it);
            if (found == names.end())
                return false;
            if (std::find(found + 1, names.end(), *found) != names.end())
                fail(fmt::format("column \"{}\" appears twice in the header; rename one of them", *found));
            columns_.at[role] = static_cast<std::size_t>(found - names.begin());
            columns_.name[role] = *found;
            return true;
        };
        if (!given.empty()) {
            if (!take(given, true))
                fail(missing(fmt::format("no column \"{}\"", given), role, names));
            return;
        }
        for (const std::string_view usual : of.usual)
            if (!usual.empty() && take(usual, false))
                return;
        const bool follows = role == frame ? !given_.time.empty() : !given_.ends.empty();
        if (of.needed && !follows)
            fail(missing(fmt::format("no column for {} (usual: {})", of.key, of.usual[0]), role, names));
    }

    static std::string missing(const std::string& what, ColumnRole role,
                               const std::vector<std::string>& names) {
        const std::string key =
            role == time     ? "tracks.time_column"
            : role >= thin_x ? std::string("tracks.columns = { ends = [\"x1\", \"y1\", \"x2\", \"y2\"] }")
                             : fmt::format("tracks.columns = {{ {} = \"...\" }}", role_names[role].key);
        const std::string all = fmt::format("{}", fmt::join(names, ", "));
        const bool is_utf8 = first_not_utf8(all) == std::string::npos;
        return fmt::format("{}; the file has {}{}; name it in {}{}", what, printable(all),
                           is_utf8 ? "" : " (not in UTF-8: save it so)", key,
                           role == frame ? ", or the times in tracks.time_column" : "");
    }

    void row(std::string_view line) {
        const std::size_t used = columns_.role_of.size();
        std::size_t filled = 0; // fields up to the last that is not empty
        const std::size_t found =
            lines_.for_each_cell(line, used, [&](std::size_t index, std::string_view cell, std::size_t) {
                const std::size_t role = columns_.role_of[index];
                if (role != roles)
                    cells_[role] = bare(cell);
            });
        if (found > fields_)
            lines_.for_each_cell(line, found, [&](std::size_t index, std::string_view cell, std::size_t) {
                filled = bare(cell).empty() ? filled : index + 1;
            });
        if (is_first_ &&
            filled == fields_ + 1) { // names of rows, as R writes them, have no name in the header
            columns_.role_of.insert(columns_.role_of.begin(), roles);
            fields_ = filled;
            has_row_names_ = true;
            rows_.warnings.push_back(
                "its rows have one field more than the header has names: the first field "
                "is passed over, as R's names of rows");
            return row(line);
        }
        is_first_ = false;
        if (filled > fields_ || (has_row_names_ && found != fields_))
            fail(fmt::format("has {} fields, and {} {}: text with \"{}\" belongs in quotes", found,
                             has_row_names_ ? "the rows before it" : "the header", fields_,
                             lines_.separator()));
        if (found < used)
            fail(fmt::format("has {} fields, and column \"{}\" would be number {}: is the line cut short?",
                             found, columns_.name[columns_.role_of.back()], used));
        if (columns_.of_trackmate && rows_.size() == 0 && !begins_a_number(cells_[x]) &&
            !begins_a_number(cells_[y]) && skipped_ < 3) {
            ++skipped_;
            return;
        }
        add();
    }

    void add() {
        double at_x = 0.0, at_y = 0.0;
        std::array<double, 4> end{};
        bool has_ends = columns_.at[thin_x] != no_column;
        for (std::size_t k = 0; k < end.size(); ++k)
            has_ends = has_ends && place(static_cast<ColumnRole>(thin_x + k), end[k]);
        const bool has_x = place(x, at_x), has_y = place(y, at_y);
        if (has_ends && !has_x) // a rod without a position of its own is in the middle of its ends
            at_x = 0.5 * (end[0] + end[2]);
        if (has_ends && !has_y)
            at_y = 0.5 * (end[1] + end[3]);
        if (!has_ends && !(has_x && has_y)) {
            if (rows_.without_place++ == 0)
                rows_.first_without_place = fmt::format("{}:{}", path_, lines_.number());
            return;
        }
        if (rows_.size() == 0) {
            // Room for as many rows as the file seems to have.
            std::size_t bytes = 0;
            for (const std::string_view cell : cells_)
                bytes += cell.size() + 1;
            const double most = lines_.bytes() / static_cast<double>(std::max<std::size_t>(bytes, 8));
            const auto count =
                static_cast<std::size_t>(std::min(most, static_cast<double>(given_.most_rows)));
            (given_.time.empty() ? (rows_.frame.reserve(count)) : (rows_.time.reserve(count)));
            rows_.id.reserve(count);
            rows_.x.reserve(count);
            rows_.y.reserve(count);
        }
        if (rows_.size() == given_.most_rows)
            fail(fmt::format(
                "more than {} rows, and {:.3g} GB of memory for them: take fewer frames, or a part "
                "of the picture",
                given_.most_rows, 41e-9 * static_cast<double>(given_.most_rows)));
        if (given_.time.empty())
            rows_.frame.push_back(whole(frame));
        else
            rows_.time.push_back(real(time));
        rows_.id.push_back(columns_.at[id] == no_column || is_missing(cells_[id]) ? no_track : whole(id));
        rows_.x.push_back(at_x);
        rows_.y.push_back(at_y);
        if (columns_.at[thin_x] != no_column) {
            rows_.heading.push_back(has_ends ? std::atan2(end[1] - end[3], end[0] - end[2]) : std::nan(""));
            rows_.length.push_back(has_ends ? std::hypot(end[1] - end[3], end[0] - end[2]) : std::nan(""));
        } else if (columns_.at[heading] != no_column)
            rows_.heading.push_back(is_missing(cells_[heading]) ? std::nan("") : real(heading));
        if (columns_.at[kind] != no_column)
            rows_.is_rod.push_back(rod(cells_[kind]));
        if (columns_.at[radius] != no_column || !given_.kinds.empty())
            rows_.radius.push_back(!rows_.is_rod.empty() && rows_.is_rod.back() ? std::nan("")
                                                                                : bead_radius());
    }

    const NamedRadius* named_radius(std::string_view cell) const {
        const auto found = std::ranges::find_if(given_.kinds, [&](const NamedRadius& of) {
            return std::ranges::count(of.names, text_in(cell)) > 0;
        });
        return found == given_.kinds.end() ? nullptr : &*found;
    }

    /// NaN where the cell is empty.
    double bead_radius() const {
        if (columns_.at[radius] != no_column) {
            const double value = is_missing(cells_[radius]) ? std::nan("") : real(radius);
            if (value <= 0.0)
                wrong(radius, "expected a radius above 0");
            return value;
        }
        const NamedRadius* const of = named_radius(cells_[kind]);
        if (!of)
            wrong(kind, "expected one of the names in tracks.bead_kinds or tracks.rod_kinds");
        return of->radius;
    }

    /// False for a place that is none.
    bool place(ColumnRole role, double& value) const {
        const std::string_view cell = cells_[role];
        const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
        if (error == std::errc{} && end == cell.data() + cell.size())
            return std::isfinite(value);
        if (is_missing(cell))
            return false;
        value = real(role);
        return std::isfinite(value);
    }

    double real(ColumnRole role) const {
        const auto value = number_in(cells_[role]);
        if (!value)
            wrong(role, "expected a number");
        if (role == time && !std::isfinite(*value))
            wrong(role, "expected a time in seconds; take rows without one out");
        return *value;
    }

    /// A whole number below 2^53, perhaps written as 12.0.
    std::int64_t whole(ColumnRole role) const {
        const std::string_view cell = cells_[role];
        std::int64_t value = 0;
        constexpr std::int64_t most = std::int64_t{1} << 53;
        const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
        if (error == std::errc{} && end == cell.data() + cell.size() && value > -most && value < most)
            return value;
        const auto number = number_in(cell);
        if (!number || !(std::abs(*number) < 0x1p53) || *number != std::floor(*number))
            wrong(role, role == frame
                            ? "expected a whole number; name a column of times in tracks.time_column"
                            : "expected a whole number; number the particles, or leave the cell empty for a "
                              "spot of no track");
        return static_cast<std::int64_t>(*number);
    }

    std::uint8_t rod(std::string_view cell) const {
        if (named_radius(cell))
            return 0;
        if (!given_.rod_kinds.empty())
            return std::ranges::find(given_.rod_kinds, text_in(cell)) != given_.rod_kinds.end();
        if (is_missing(cell) || cell == "0" || cell == "0.0" || alike(cell, "bead"))
            return 0;
        if (cell == "1" || cell == "1.0" || alike(cell, "rod") || alike(cell, "motile") ||
            alike(cell, "apolar"))
            return 1;
        wrong(kind, given_.kinds.empty() || columns_.at[radius] != no_column
                        ? "expected bead or rod, 0 or 1"
                        : "expected one of the names in tracks.bead_kinds or tracks.rod_kinds");
    }

    [[noreturn]] void wrong(ColumnRole role, const std::string& expected) const {
        std::string text(cells_[role]), better = text;
        std::ranges::replace(better, ',', '.');
        const bool comma = better != text && number_in(better);
        fail(fmt::format("{} = \"{}\": {}{}", columns_.name[role], shown(text), expected,
                         comma ? "; write it as " + better : ""));
    }

    std::string path_;
    TrackColumns given_;
    LinesOfBlocks lines_;
    ColumnRoles columns_;
    std::array<std::string_view, roles> cells_{};
    std::size_t skipped_ = 0, fields_ = 0; ///< fields of the header
    bool is_first_ = true, has_row_names_ = false;
    TrackRows rows_;
};

} // namespace

TrackRows read_track_csv(const std::filesystem::path& file, const TrackColumns& columns,
                         const TrackProgress& on_progress) {
    return CsvTracks(file, columns).read(on_progress);
}

void write_plain_csv(const TrackRows& rows, const std::filesystem::path& file) {
    PendingFile pending(file);
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "{},particle,x,y{}{}\n", rows.time.empty() ? "frame" : "t",
                   rows.heading.empty() ? "" : ",theta", rows.is_rod.empty() ? "" : ",kind");
    for (std::size_t row = 0; row < rows.size(); ++row) {
        if (rows.time.empty())
            fmt::format_to(out, "{},", rows.frame[row]);
        else
            fmt::format_to(out, "{},", rows.time[row]);
        if (rows.id[row] != no_track)
            fmt::format_to(out, "{}", rows.id[row]);
        fmt::format_to(out, ",{},{}", rows.x[row], rows.y[row]);
        if (!rows.heading.empty()) {
            text.push_back(',');
            if (!std::isnan(rows.heading[row]))
                fmt::format_to(out, "{}", rows.heading[row]);
        }
        fmt::format_to(out, "{}\n", rows.is_rod.empty() ? "" : rows.is_rod[row] ? ",rod" : ",bead");
        if (text.size() > (std::size_t{1} << 20)) { // a film may be larger than the memory left
            pending.write({text.data(), text.size()});
            text.clear();
        }
    }
    pending.write({text.data(), text.size()});
    pending.commit();
}

} // namespace rodwake::store
