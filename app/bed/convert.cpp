#include "rodwake/app/convert.hpp"

#include "rodwake/app/child_program.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "run/log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// A line of the converter is a fraction, or a message, a warning if it says so.
void hear(const std::string& line, const RunContext& context,
          const std::function<void(double)>& on_progress) {
    double part = 0.0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), part);
    constexpr std::string_view warning = "warning: ", done = "done: ";
    if (error == std::errc{} && end == line.data() + line.size())
        on_progress(part);
    else if (context.log && line.starts_with(warning))
        context.log(Severity::warning, line.substr(warning.size()));
    else if (context.log)
        context.log(Severity::info, line.starts_with(done) ? line.substr(done.size()) : line);
}

/// False after a stop. The first of the arguments is the file; behind `--` the name "-x.csv" is no option.
bool run_converter(const Words& arguments, const RunContext& context,
                   const std::function<void(const std::string&)>& on_line) {
    if (context.converter.empty())
        throw RunError(
            "files of other programs are read by Python, and no converter is known to this program");
    Words command = context.converter;
    command.insert(command.end(), arguments.begin() + 1, arguments.end());
    command.insert(command.end(), {"--", arguments.front()});
    const ChildEnd ended = run_child(
        command, "files of other programs need python3 with numpy and h5py (tools/quickstart --deps-only)",
        [&] { return context.stopped(); }, on_line);
    if (context.stopped())
        return false;
    std::string why = ended.error.substr(0, ended.error.find_last_not_of(" \n") + 1);
    if (why.empty())
        why =
            fmt::format("{}: the converter ended with {} and without a word", arguments.front(), ended.code);
    if (ended.code == 2)
        throw InputError(why);
    if (ended.code != 0)
        throw RunError(why);
    return true;
}

/// How the columns and kinds of the file are to be read. CSV is normalised before, by our own reader.
Words reading_options(const store::TrackColumns& columns, const std::string& group, TrackFormat format) {
    Words words = {"--format=" + std::string(to_string(format))};
    const auto add = [&](const std::string& option, const std::string& value) {
        if (!value.empty() && format != TrackFormat::csv)
            words.push_back(fmt::format("--{}={}", option, value));
    };
    add("group", group);
    add("time-column", columns.time);
    const std::pair<const char*, const std::string&> names[] = {{"id", columns.id},
                                                                {"x", columns.x},
                                                                {"y", columns.y},
                                                                {"heading", columns.heading},
                                                                {"kind", columns.kind}};
    for (const auto& [name, value] : names)
        add("column", value.empty() ? "" : fmt::format("{}={}", name, value));
    for (const std::string& kind : columns.rod_kinds)
        add("rod-kind", kind);
    return words;
}

/// Trajectories of a run or of the runs of an ensemble; else the file itself.
std::vector<fs::path> trajectories(const fs::path& in) {
    if (!fs::is_directory(in))
        return {in};
    if (fs::exists(in / "trajectory.h5md"))
        return {in / "trajectory.h5md"};
    std::vector<fs::path> found;
    if (fs::is_directory(in / "runs"))
        for (const fs::directory_entry& run : fs::directory_iterator(in / "runs"))
            if (fs::exists(run.path() / "trajectory.h5md"))
                found.push_back(run.path() / "trajectory.h5md");
    if (found.empty() && fs::exists(in / "result.h5"))
        return {in / "result.h5"};
    if (found.empty())
        throw InputError(
            in.string() +
            ": holds no trajectory.h5md, nor do runs in it, and no result.h5; a bed writes it with "
            "granular.output.formats = [\"h5md\"], and rodwake replay makes it of an "
            "archive");
    std::ranges::sort(found);
    return found;
}

/// A file that goes with the object.
struct TemporaryFile {
    fs::path path;
    ~TemporaryFile() {
        std::error_code ignored;
        fs::remove(path, ignored);
    }
};

bool convert_file(const ConvertRequest& request, const fs::path& in, const fs::path& out,
                  const RunContext& context) {
    if (fs::exists(out) && !request.force)
        throw InputError(out.string() +
                         ": exists already; --force replaces it, or name another file with -o");
    const TrackFormat format =
        request.format == TrackFormat::automatic ? store::track_format(in) : request.format;
    // CSV without the columns, separators and gaps of other programs.
    const TemporaryFile plain{format == TrackFormat::csv ? fs::path(request.out.string() + ".plain.csv")
                                                         : fs::path()};
    if (format == TrackFormat::csv)
        store::write_plain_csv(
            store::read_track_csv(in, request.columns, [&](double) { return !context.stopped(); }),
            plain.path);
    Words words = {(format == TrackFormat::csv ? plain.path : in).string(), "--output=" + out.string(),
                   "--force"};
    for (std::string& word : reading_options(request.columns, request.group, format))
        words.push_back(std::move(word));
    const std::pair<const char*, const std::string&> others[] = {
        {"frames", request.frames}, {"unit", request.unit}, {"rods", request.rods}};
    for (const auto& [option, value] : others)
        if (!value.empty())
            words.push_back(fmt::format("--{}={}", option, value));
    Progress progress(context, "convert", 1.0, "of " + in.filename().string());
    return !context.stopped() && run_converter(words, context, [&](const std::string& line) {
        hear(line, context, [&](double part) { progress.update(part); });
    });
}

} // namespace

void name_column(ConvertRequest& request, std::string_view role, const std::string& name) {
    store::TrackColumns& c = request.columns;
    const std::pair<std::string_view, std::string*> known[] = {
        {"frame", &c.frame}, {"id", &c.id},           {"x", &c.x},
        {"y", &c.y},         {"heading", &c.heading}, {"kind", &c.kind}};
    const auto* const at = std::ranges::find(known, role, &std::pair<std::string_view, std::string*>::first);
    if (at == std::end(known) || name.empty())
        throw InputError(
            fmt::format("column {}={}: expected frame, id, x, y, heading or kind, and a name", role, name));
    *at->second = name;
}

bool convert(const ConvertRequest& request, const RunContext& context) {
    const std::vector<fs::path> all = trajectories(request.in);
    for (std::size_t k = 0; k < all.size(); ++k) {
        fs::path out = request.out;
        if (all.size() > 1)
            out.replace_filename(fmt::format("{}_{}{}", out.stem().string(),
                                             all[k].parent_path().filename().string(),
                                             out.extension().string()));
        if (!convert_file(request, all[k], out, context))
            return false;
    }
    return true;
}

namespace {

Words reading_options(const scene::Tracks& keys, TrackFormat format) {
    const scene::TracksColumns& c = keys.columns;
    const store::TrackColumns columns{c.frame,          c.id, c.x,   c.y,           c.heading, c.kind,
                                      keys.time_column, {},   false, keys.rod_kinds};
    return reading_options(columns, keys.group, format);
}

} // namespace

fs::path film_of(const scene::Tracks& keys, const fs::path& file, TrackFormat format, const fs::path& folder,
                 const RunContext& context, const std::function<void(double)>& on_progress) {
    const Words options = reading_options(keys, format);
    const std::uint64_t key = store::content_hash(file, fmt::format("film 1\n{}", fmt::join(options, "\n")));
    fs::path film = folder / fmt::format("film_{:016x}.h5md", key);
    if (fs::exists(film))
        return film;
    Words words = {file.string(), "--output=" + film.string()};
    words.insert(words.end(), options.begin(), options.end());
    const bool done = run_converter(words, context, [&](const std::string& line) {
        if (!line.starts_with("warning: ") && !line.starts_with("done: ")) // the line on its rows says both
            hear(line, context, on_progress);
    });
    return done ? film : fs::path();
}

std::string look_into(const scene::Tracks& keys, const fs::path& file, TrackFormat format,
                      const RunContext& context) {
    Words words = {file.string(), "--look"};
    for (std::string& word : reading_options(keys, format))
        words.push_back(std::move(word));
    std::string found;
    run_converter(words, context, [&](const std::string& line) {
        if (line.starts_with("done: "))
            found = line.substr(6);
    });
    return found;
}

} // namespace rodwake::app
