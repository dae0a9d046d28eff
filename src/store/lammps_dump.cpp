// Tracks from text dumps of LAMMPS and of programs that write such.

#include "frame_rows.hpp"
#include "text_lines.hpp"

#include "rodwake/core/spelling.hpp"

#include <fmt/ranges.h>

#include <array>

namespace rodwake::store {

namespace {

constexpr std::size_t absent = static_cast<std::size_t>(-1);

/// Bounds of the box along x and y.
struct DumpBox {
    std::array<double, 2> low{}, high{};
    bool periodic = true, tilted = false, known = false;
};

/// Which word of an atom's line is what.
struct DumpColumns {
    std::size_t id = absent, x = absent, y = absent, heading = absent, kind = absent, last = 0;
    bool scaled = false;
    std::vector<std::string> names;
};

class LammpsDump {
public:
    LammpsDump(const std::filesystem::path& path, const TrackColumns& given)
        : path_(path.string()), given_(given), lines_(path),
          out_(given, [this] { return fmt::format("{}:{}", path_, lines_.number()); }) {}

    TrackRows read(const TrackProgress& on_progress) {
        std::string_view line;
        while (lines_.next(line)) {
            if (without_blanks(line).empty())
                continue;
            if (!line.starts_with("ITEM:"))
                out_.fail(fmt::format("\"{}\": expected a line that begins with ITEM:; has something been "
                                      "added to the dump?",
                                      shown(line)));
            line.remove_prefix(5);
            item(line);
            if (!on_progress(lines_.part()))
                break;
        }
        if (step_ || count_)
            out_.fail("the last frame is cut short; remove its lines from the end of the dump");
        out_.rows().length_unit = unit_;
        return out_.take(path_);
    }

private:
    void item(std::string_view rest) {
        const std::string_view name = next_word(rest);
        if (name == "TIMESTEP")
            step_ = whole(value_line());
        else if (name == "TIME")
            time_ = real(value_line());
        else if (name == "UNITS")
            unit_ = shown(without_blanks(value_line()));
        else if (name == "NUMBER")
            count_ = whole(value_line());
        else if (name == "BOX")
            read_box(rest);
        else if (name == "ATOMS")
            read_atoms(rest);
        else
            out_.fail(fmt::format("ITEM: {}: expected a dump of atoms (ITEM: TIMESTEP, NUMBER OF ATOMS, BOX "
                                  "BOUNDS, ATOMS)",
                                  shown(name)));
    }

    std::string_view value_line() {
        std::string_view line;
        if (!lines_.next(line))
            out_.fail("the dump ends here; remove the last frame if it is cut short");
        return without_blanks(line);
    }

    std::int64_t whole(std::string_view text) const {
        const auto value = whole_in(text);
        if (!value || *value < 0)
            out_.fail(fmt::format("\"{}\": expected a whole number, not below 0", shown(text)));
        return *value;
    }

    double real(std::string_view text) const {
        const auto value = number_in(text);
        if (!value)
            out_.fail(fmt::format("\"{}\": expected a number", shown(text)));
        return *value;
    }

    /// "BOUNDS [xy xz yz] pp pp ff", then a line of low, high and perhaps a tilt for each of x, y, z.
    void read_box(std::string_view rest) {
        DumpBox box;
        std::vector<std::string_view> flags;
        for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest))
            flags.push_back(word);
        box.tilted = std::ranges::find(flags, "abc") != flags.end();
        std::size_t axis = 0;
        for (const std::string_view flag : flags)
            if (flag.size() == 2 && flag.find_first_not_of("pfsm") == std::string_view::npos && axis++ < 2)
                box.periodic &= flag == "pp"; // without flags, as in old dumps, it is
        for (std::size_t k = 0; k < 3; ++k) {
            std::string_view line = value_line();
            if (line.starts_with("ITEM:"))
                out_.fail("expected the bounds of the box, low and high, for x, y and z");
            const double low = real(next_word(line)), high = real(next_word(line));
            const std::string_view tilt = next_word(line);
            if (k < 2) {
                box.low[k] = low;
                box.high[k] = high;
            }
            if (!tilt.empty())
                box.tilted |= real(tilt) != 0.0;
        }
        box.known = true;
        box_ = box;
    }

    void read_atoms(std::string_view names) {
        if (!step_)
            out_.fail("ITEM: ATOMS without ITEM: TIMESTEP before it");
        if (!count_)
            out_.fail("ITEM: ATOMS without ITEM: NUMBER OF ATOMS before it");
        if (names != header_ || columns_.names.empty())
            find_columns(names);
        out_.begin(*step_, time_);
        if (box_.known)
            out_.box({box_.high[0] - box_.low[0], box_.high[1] - box_.low[1], box_.periodic, box_.tilted});
        if (columns_.scaled && (!box_.known || box_.tilted))
            out_.fail("scaled places (xs, ys) need an upright box; dump x and y");
        std::string_view line;
        for (std::int64_t k = 0; k < *count_; ++k) {
            if (!lines_.next(line) || line.starts_with("ITEM:"))
                out_.fail(
                    fmt::format("step {} has {} of its {} atoms: is the dump cut short? Remove this frame",
                                *step_, k, *count_));
            atom(line);
        }
        step_.reset();
        time_.reset();
        count_.reset();
        box_ = {};
    }

    void find_columns(std::string_view names) {
        header_ = names;
        columns_ = {};
        for (std::string_view word = next_word(names); !word.empty(); word = next_word(names))
            columns_.names.emplace_back(word);
        const auto at = [&](std::string_view name) {
            const auto found = std::ranges::find(columns_.names, name);
            return found == columns_.names.end() ? absent
                                                 : static_cast<std::size_t>(found - columns_.names.begin());
        };
        const auto named = [&](const std::string& name, const char* key) {
            const std::size_t found = at(name);
            if (found == absent)
                fail_column(fmt::format("no column \"{}\"", name), key);
            return found;
        };
        constexpr std::pair<std::string_view, std::string_view> places[] = {
            {"x", "y"}, {"xu", "yu"}, {"xs", "ys"}, {"xsu", "ysu"}};
        for (const auto& [x, y] : places)
            if (columns_.x == absent && at(x) != absent && at(y) != absent) {
                columns_.x = at(x);
                columns_.y = at(y);
            }
        if (!given_.x.empty())
            columns_.x = named(given_.x, "x");
        if (!given_.y.empty())
            columns_.y = named(given_.y, "y");
        if (columns_.x == absent || columns_.y == absent)
            fail_column("no columns x and y, xu and yu, or xs and ys", "x");
        columns_.scaled = columns_.names[columns_.x].starts_with("xs");
        columns_.id = given_.id.empty() ? at("id") : named(given_.id, "id");
        columns_.heading =
            given_.heading.empty() ? std::min(at("theta"), at("heading")) : named(given_.heading, "heading");
        const std::size_t type = given_.rod_kinds.empty() ? at("kind") : std::min(at("kind"), at("type"));
        columns_.kind = given_.kind.empty() ? type : named(given_.kind, "kind");
        for (const std::size_t used : {columns_.id, columns_.x, columns_.y, columns_.heading, columns_.kind})
            columns_.last = used == absent ? columns_.last : std::max(columns_.last, used);
    }

    [[noreturn]] void fail_column(const std::string& what, const char* key) const {
        out_.fail(fmt::format("{}; the dump has {}; name it in tracks.columns = {{ {} = \"...\" }}", what,
                              fmt::join(columns_.names, ", "), key));
    }

    double real_of(std::size_t column) const {
        const auto value = number_in(words_[column]);
        if (!value)
            wrong(column, "expected a number");
        return *value;
    }

    [[noreturn]] void wrong(std::size_t column, const char* expected) const {
        out_.fail(fmt::format("{} = \"{}\": {}", columns_.names[column], shown(words_[column]), expected));
    }

    void atom(std::string_view line) {
        words_.clear();
        while (words_.size() <= columns_.last) {
            words_.push_back(next_word(line));
            if (words_.back().empty())
                out_.fail(fmt::format("has {} words, and column \"{}\" would be number {}: is the line cut "
                                      "short?",
                                      words_.size() - 1, columns_.names[columns_.last], columns_.last + 1));
        }
        std::optional<std::int64_t> id = no_track; // lines of a dump come in any order
        if (columns_.id != absent && !(id = whole_in(words_[columns_.id])))
            wrong(columns_.id, "expected a whole number");
        double x = real_of(columns_.x), y = real_of(columns_.y);
        if (columns_.scaled) {
            x = box_.low[0] + x * (box_.high[0] - box_.low[0]);
            y = box_.low[1] + y * (box_.high[1] - box_.low[1]);
        }
        std::optional<double> heading;
        if (columns_.heading != absent)
            heading = real_of(columns_.heading);
        std::optional<bool> rod;
        if (columns_.kind != absent)
            rod = names_rod(given_, words_[columns_.kind]);
        out_.add(id, x, y, heading, rod);
    }

    std::string path_;
    const TrackColumns& given_;
    LinesOfBlocks lines_;
    FrameRows out_;
    std::optional<std::int64_t> step_, count_;
    std::optional<double> time_;
    DumpBox box_;
    DumpColumns columns_;
    std::string header_, unit_;
    std::vector<std::string_view> words_;
};

} // namespace

TrackRows read_lammps_dump(const std::filesystem::path& file, const TrackColumns& columns,
                           const TrackProgress& on_progress) {
    return LammpsDump(file, columns).read(on_progress);
}

} // namespace rodwake::store
