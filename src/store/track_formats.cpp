// Which format a file of tracks has.

#include "rodwake/core/error.hpp"
#include "rodwake/store/track_file.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>

namespace rodwake::store {

namespace {

TrackFormat format_by_content(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string start(256, '\0');
    in.read(start.data(), static_cast<std::streamsize>(start.size()));
    start.resize(static_cast<std::size_t>(in.gcount()));
    if (start.starts_with("\x89HDF\r\n\x1A\n"))
        return TrackFormat::h5md;
    if (start.starts_with("\xDF\x65\xDF\x65\xDF\x65\xDF\x65"))
        return TrackFormat::gsd;
    const std::size_t first = start.find_first_not_of("\xEF\xBB\xBF \t\r\n");
    const std::string_view text = std::string_view(start).substr(std::min(first, start.size()));
    if (text.starts_with('<'))
        return TrackFormat::trackmate;
    if (text.starts_with("ITEM:"))
        return TrackFormat::lammps;
    // XYZ: the first line is the number of particles of a frame, and nothing else.
    const std::size_t end = text.find_first_of("\r\n");
    const std::string_view line = text.substr(0, end);
    const std::size_t from = line.find_first_not_of(" \t"), to = line.find_last_not_of(" \t");
    const bool counts =
        end != std::string_view::npos && from != std::string_view::npos &&
        line.substr(from, to - from + 1).find_first_not_of("0123456789") == std::string_view::npos;
    return counts ? TrackFormat::xyz : TrackFormat::automatic;
}

} // namespace

TrackFormat track_format(const std::filesystem::path& file) {
    if (!std::filesystem::is_regular_file(file))
        throw InputError(file.string() + ": no such file of tracks");
    const TrackFormat format = format_by_content(file);
    if (format != TrackFormat::automatic)
        return format;
    constexpr std::pair<std::string_view, TrackFormat> endings[] = {
        {".xyz", TrackFormat::xyz},           {".extxyz", TrackFormat::xyz},
        {".gsd", TrackFormat::gsd},           {".h5md", TrackFormat::h5md},
        {".h5", TrackFormat::h5md},           {".hdf5", TrackFormat::h5md},
        {".dump", TrackFormat::lammps},       {".lammpstrj", TrackFormat::lammps},
        {".lammpsdump", TrackFormat::lammps}, {".xml", TrackFormat::trackmate}};
    std::string ending = (file.extension() == ".gz" ? file.stem() : file).extension().string();
    std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
    const auto found = std::ranges::find(endings, ending, &std::pair<std::string_view, TrackFormat>::first);
    return found == std::end(endings) ? TrackFormat::csv : found->second;
}

} // namespace rodwake::store
