// Tracks from extended XYZ (libAtoms), and from XYZ without its second line's keys.

#include "frame_rows.hpp"
#include "text_lines.hpp"

#include "rodwake/core/spelling.hpp"

#include <fmt/ranges.h>

#include <array>
#include <map>

namespace rodwake::store {

namespace {

constexpr std::size_t nowhere = static_cast<std::size_t>(-1);

/// Which word of a particle's line is what.
struct XyzColumns {
    std::size_t place = nowhere, id = nowhere, heading = nowhere, kind = nowhere, words = 0;
};

/// key=value pairs of a second line; values may stand in quotes, braces or brackets. A word alone is true.
std::map<std::string, std::string, std::less<>> keys_in(std::string_view line) {
    std::map<std::string, std::string, std::less<>> keys;
    std::size_t at = 0;
    const auto end_of = [&](std::string_view stops) {
        return std::min(line.find_first_of(stops, at), line.size());
    };
    while ((at = line.find_first_not_of(" \t", at)) != std::string_view::npos) {
        const std::size_t name_end = end_of("= \t");
        const std::string name(line.substr(at, name_end - at));
        at = name_end;
        if (at >= line.size() || line[at] != '=') {
            keys.emplace(name, "T");
            continue;
        }
        ++at;
        constexpr std::string_view open = "\"'{[", close = "\"'}]";
        const std::size_t kind = at < line.size() ? open.find(line[at]) : std::string_view::npos;
        at += kind != std::string_view::npos;
        const std::size_t end =
            kind == std::string_view::npos ? end_of(" \t") : end_of(close.substr(kind, 1));
        keys.emplace(name, line.substr(at, end - at));
        at = std::min(line.size(), end + (kind != std::string_view::npos));
    }
    return keys;
}

class XyzTracks {
public:
    XyzTracks(const std::filesystem::path& path, const TrackColumns& given)
        : path_(path.string()), given_(given), lines_(path),
          out_(given, [this] { return fmt::format("{}:{}", path_, lines_.number()); }) {}

    TrackRows read(const TrackProgress& on_progress) {
        std::string_view line;
        while (lines_.next(line)) {
            line = without_blanks(line);
            if (line.empty())
                continue;
            const auto count = whole_in(line);
            if (!count || *count < 0)
                out_.fail(
                    fmt::format("\"{}\": expected the number of particles of the next frame", shown(line)));
            frame(*count);
            if (!on_progress(lines_.part()))
                break;
        }
        return out_.take(path_);
    }

private:
    void frame(std::int64_t count) {
        std::string_view line;
        if (!lines_.next(line))
            out_.fail("a frame without its second line: is the file cut short?");
        const auto keys = keys_in(line);
        find_columns(keys);
        out_.begin(step_of(keys), time_of(keys));
        read_lattice(keys);
        ++frames_;
        for (std::int64_t k = 0; k < count; ++k) {
            if (!lines_.next(line))
                out_.fail(
                    fmt::format("frame {} has {} of its {} particles: is the file cut short? Remove the "
                                "frame",
                                frames_, k, count));
            particle(line);
        }
    }

    using Keys = std::map<std::string, std::string, std::less<>>;

    /// The value of the first of the keys that is there.
    static const std::string* value_of(const Keys& keys, std::initializer_list<std::string_view> names) {
        for (const std::string_view name : names)
            if (const auto found = keys.find(name); found != keys.end())
                return &found->second;
        return nullptr;
    }

    /// In all frames, or by their order.
    std::int64_t step_of(const Keys& keys) {
        const std::string* step = value_of(keys, {"Step", "step", "Timestep", "timestep", "frame"});
        const auto value = step ? whole_in(*step) : std::nullopt;
        if (step && !value)
            out_.fail(fmt::format("Step={}: expected a whole number", shown(*step)));
        if (frames_ == 0)
            has_steps_ = value.has_value();
        else if (has_steps_ != value.has_value())
            out_.fail(
                fmt::format("frame {} has {}Step, unlike those before", frames_ + 1, value ? "a " : "no "));
        return value ? *value : static_cast<std::int64_t>(frames_);
    }

    std::optional<double> time_of(const Keys& keys) const {
        const std::string* time = given_.time.empty() ? value_of(keys, {"Time", "time"})
                                                      : value_of(keys, {std::string_view(given_.time)});
        if (!time) {
            if (!given_.time.empty())
                out_.fail(
                    fmt::format("no {}= (tracks.time_column) in the second line of the frame; it has {}",
                                given_.time, fmt::join(names_of(keys), ", ")));
            return std::nullopt;
        }
        const auto value = number_in(*time);
        if (!value)
            out_.fail(fmt::format("Time={}: expected a number", shown(*time)));
        return value;
    }

    static std::vector<std::string> names_of(const Keys& keys) {
        std::vector<std::string> names;
        for (const auto& [name, value] : keys)
            names.push_back(shown(name));
        return names;
    }

    void read_lattice(const Keys& keys) {
        const std::string* lattice = value_of(keys, {"Lattice"});
        if (!lattice)
            return;
        std::array<double, 9> edges{};
        std::string_view rest = *lattice;
        for (double& edge : edges) {
            const std::string_view word = next_word(rest);
            const auto value = number_in(word);
            if (!value)
                out_.fail(fmt::format("Lattice=\"{}\": expected nine numbers", shown(*lattice)));
            edge = *value;
        }
        bool periodic = true; // as the format has it, without pbc
        if (const std::string* pbc = value_of(keys, {"pbc"})) {
            std::vector<bool> flags;
            for (const char c : *pbc)
                if (std::string_view("TtFf01").find(c) != std::string_view::npos)
                    flags.push_back(c == 'T' || c == 't' || c == '1');
            periodic = flags.size() >= 2 && flags[0] && flags[1];
        }
        const bool tilted = edges[1] != 0.0 || edges[2] != 0.0 || edges[3] != 0.0 || edges[5] != 0.0 ||
                            edges[6] != 0.0 || edges[7] != 0.0;
        out_.box({edges[0], edges[4], periodic, tilted});
    }

    void find_columns(const Keys& keys) {
        const std::string* text = value_of(keys, {"Properties", "properties"});
        const std::string properties = text ? *text : "species:S:1:pos:R:3";
        if (properties == properties_ && columns_.words > 0)
            return;
        properties_ = properties;
        columns_ = {};
        read_properties(given_.x.empty() ? "pos" : given_.x);
        columns_.place = named(given_.x.empty() ? "pos" : given_.x, "x");
        columns_.id = given_.id.empty() ? usual({"id"}) : named(given_.id, "id");
        columns_.heading =
            given_.heading.empty() ? usual({"theta", "heading"}) : named(given_.heading, "heading");
        columns_.kind = !given_.kind.empty()       ? named(given_.kind, "kind")
                        : given_.rod_kinds.empty() ? usual({"kind"})
                                                   : usual({"kind", "type", "species"});
    }

    /// name:type:number of words, one behind the other; `place` has two at least.
    void read_properties(std::string_view place) {
        properties_at_.clear();
        std::string_view rest = properties_;
        const auto part = [&] {
            const std::size_t end = std::min(rest.find(':'), rest.size());
            const std::string_view word = rest.substr(0, end);
            rest.remove_prefix(std::min(rest.size(), end + 1));
            return word;
        };
        while (!rest.empty()) {
            const std::string_view name = part(), type = part();
            const auto count = whole_in(part());
            if (name.empty() || type.size() != 1 || !count || *count < 1 || *count > 1000)
                out_.fail(fmt::format("Properties={}: expected name:type:number, as species:S:1:pos:R:3",
                                      shown(properties_)));
            if (name == place && *count < 2)
                out_.fail(
                    fmt::format("Properties: {} has one component; two or three are needed", shown(name)));
            properties_at_.emplace_back(name, columns_.words);
            columns_.words += static_cast<std::size_t>(*count);
        }
    }

    std::size_t usual(std::initializer_list<const char*> all) const {
        for (const std::string_view name : all)
            for (const auto& [known, at] : properties_at_)
                if (known == name)
                    return at;
        return nowhere;
    }

    std::size_t named(const std::string& name, const char* key) const {
        const std::size_t found = usual({name.c_str()});
        if (found == nowhere) {
            std::vector<std::string> names;
            for (const auto& [known, at] : properties_at_)
                names.push_back(shown(known));
            out_.fail(fmt::format(
                "no column \"{}\"; the frame has {}; name it in tracks.columns = {{ {} = \"...\" }}", name,
                fmt::join(names, ", "), key));
        }
        return found;
    }

    double real_of(std::size_t column, const char* name) const {
        const auto value = number_in(words_[column]);
        if (!value)
            out_.fail(fmt::format("{} = \"{}\": expected a number", name, shown(words_[column])));
        return *value;
    }

    void particle(std::string_view line) {
        words_.clear();
        while (words_.size() < columns_.words) {
            words_.push_back(next_word(line));
            if (words_.back().empty())
                out_.fail(fmt::format("has {} words, expected the {} of Properties={}", words_.size() - 1,
                                      columns_.words, shown(properties_)));
        }
        std::optional<std::int64_t> id;
        if (columns_.id != nowhere && !(id = whole_in(words_[columns_.id])))
            out_.fail(fmt::format("id = \"{}\": expected a whole number", shown(words_[columns_.id])));
        std::optional<double> heading;
        if (columns_.heading != nowhere)
            heading = real_of(columns_.heading, "heading");
        std::optional<bool> rod;
        if (columns_.kind != nowhere)
            rod = names_rod(given_, words_[columns_.kind]);
        out_.add(id, real_of(columns_.place, "x"), real_of(columns_.place + 1, "y"), heading, rod);
    }

    std::string path_;
    const TrackColumns& given_;
    LinesOfBlocks lines_;
    FrameRows out_;
    XyzColumns columns_;
    std::string properties_;
    std::vector<std::pair<std::string, std::size_t>> properties_at_; ///< first word of each
    std::size_t frames_ = 0;
    bool has_steps_ = false;
    std::vector<std::string_view> words_;
};

} // namespace

TrackRows read_xyz_tracks(const std::filesystem::path& file, const TrackColumns& columns,
                          const TrackProgress& on_progress) {
    return XyzTracks(file, columns).read(on_progress);
}

} // namespace rodwake::store
