// Tracks from TrackMate's XML.

#include "track_formats.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>
#include <pugixml.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <unordered_map>
#include <unordered_set>

namespace rodwake::store {

namespace {

constexpr std::size_t nobody = static_cast<std::size_t>(-1);

/// A spot as a node of the graph of links.
struct Links {
    std::size_t next = nobody;
    int before = 0, after = 0; ///< how many
};

class TrackMateFile {
public:
    explicit TrackMateFile(const std::filesystem::path& path) : path_(path.string()) {
        const pugi::xml_parse_result parsed = document_.load_file(path.c_str());
        if (!parsed)
            throw InputError(fmt::format("{}:{}: no XML ({}); is the file whole? Save it again in TrackMate",
                                         path_, line_of(parsed.offset), parsed.description()));
        model_ = document_.child("TrackMate").child("Model");
        if (!model_.child("AllSpots"))
            throw InputError(path_ + ": no <TrackMate><Model><AllSpots>: is this TrackMate's file? Its "
                                     "\"Export tracks to XML\" leaves the spots out; save with \"Save\", or "
                                     "export the spots as CSV");
    }

    TrackRows read() {
        spots();
        edges();
        number_chains();
        if (rows_.size() == 0)
            throw InputError(path_ + ": has no visible spot: lower TrackMate's filters and save again");
        rows_.length_unit = model_.attribute("spatialunits").as_string();
        return std::move(rows_);
    }

private:
    std::size_t line_of(std::ptrdiff_t offset) const {
        std::ifstream in(path_, std::ios::binary);
        std::size_t line = 1;
        for (char c = 0; offset > 0 && in.get(c); --offset)
            line += c == '\n';
        return line;
    }

    double number(const pugi::xml_node& node, const char* name) const {
        const pugi::xml_attribute found = node.attribute(name);
        if (!found)
            throw InputError(fmt::format("{}:{}: <{}> without {}; save the file again in TrackMate", path_,
                                         line_of(node.offset_debug()), node.name(), name));
        return found.as_double(std::nan(""));
    }

    std::int64_t whole(const pugi::xml_node& node, const char* name) const {
        const double value = number(node, name);
        if (!(std::abs(value) < 0x1p53 && value == std::floor(value)))
            throw InputError(fmt::format("{}:{}: {} = \"{}\" of <{}>: expected a whole number", path_,
                                         line_of(node.offset_debug()), name, node.attribute(name).as_string(),
                                         node.name()));
        return static_cast<std::int64_t>(value);
    }

    void spots() {
        bool deep = false;
        for (const pugi::xml_node& of_frame : model_.child("AllSpots").children("SpotsInFrame"))
            for (const pugi::xml_node& spot : of_frame.children("Spot")) {
                if (spot.attribute("VISIBILITY").as_int(1) == 0) {
                    ++rows_.hidden;
                    continue;
                }
                deep |= spot.attribute("POSITION_Z").as_double() != 0.0;
                const double x = number(spot, "POSITION_X"), y = number(spot, "POSITION_Y");
                if (!std::isfinite(x) || !std::isfinite(y)) {
                    if (rows_.without_place++ == 0)
                        rows_.first_without_place = fmt::format("{}:{}", path_, line_of(spot.offset_debug()));
                    continue;
                }
                if (!index_.emplace(whole(spot, "ID"), rows_.size()).second)
                    throw InputError(fmt::format("{}:{}: ID = {} stands for a spot before; save the file "
                                                 "again in TrackMate",
                                                 path_, line_of(spot.offset_debug()),
                                                 spot.attribute("ID").as_string()));
                rows_.frame.push_back(whole(spot, "FRAME"));
                rows_.x.push_back(x);
                rows_.y.push_back(y);
            }
        if (deep && !rows_.frame.empty() &&
            std::ranges::all_of(rows_.frame, [&](std::int64_t f) { return f == rows_.frame[0]; }))
            throw InputError(path_ + ": all spots are in one frame, at different heights: the film was read "
                                     "as a stack in z; swap z and t (Image > Properties) and track again");
    }

    /// Tracks that TrackMate's filters left; all, where the file does not say.
    bool counts(const pugi::xml_node& track) {
        if (!filtered_) {
            filtered_.emplace();
            for (const pugi::xml_node& id : model_.child("FilteredTracks").children("TrackID"))
                filtered_->insert(id.attribute("TRACK_ID").as_llong(-1));
        }
        return !model_.child("FilteredTracks") || filtered_->contains(track.attribute("TRACK_ID").as_llong());
    }

    void edges() {
        links_.resize(rows_.size());
        std::vector<std::pair<std::size_t, std::size_t>> all;
        for (const pugi::xml_node& track : model_.child("AllTracks").children("Track"))
            for (const pugi::xml_node& edge : track.children("Edge")) {
                if (!counts(track))
                    break;
                const auto from = index_.find(whole(edge, "SPOT_SOURCE_ID")),
                           to = index_.find(whole(edge, "SPOT_TARGET_ID"));
                if (from == index_.end() || to == index_.end())
                    continue; // a hidden spot
                const bool forward = rows_.frame[from->second] < rows_.frame[to->second];
                all.emplace_back(forward ? from->second : to->second, forward ? to->second : from->second);
                ++links_[all.back().first].after;
                ++links_[all.back().second].before;
            }
        for (const auto& [from, to] : all) {
            if (links_[from].after > 1 || links_[to].before > 1)
                ++rows_.branches;
            else
                links_[from].next = to;
        }
    }

    /// Spots that follow one another are one particle; one without any link is in no track.
    void number_chains() {
        rows_.id.assign(rows_.size(), no_track);
        std::vector<bool> follows(rows_.size(), false);
        for (const Links& links : links_)
            if (links.next != nobody)
                follows[links.next] = true;
        std::int64_t id = 0;
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            if (follows[i] || links_[i].before + links_[i].after == 0)
                continue;
            for (std::size_t at = i; at != nobody; at = links_[at].next)
                rows_.id[at] = id;
            ++id;
        }
    }

    std::string path_;
    pugi::xml_document document_;
    pugi::xml_node model_;
    TrackRows rows_;
    std::unordered_map<std::int64_t, std::size_t> index_; ///< of a spot's ID
    std::optional<std::unordered_set<long long>> filtered_;
    std::vector<Links> links_;
};

} // namespace

TrackRows read_trackmate(const std::filesystem::path& file, const TrackColumns& columns) {
    if (columns.own_times)
        throw InputError(file.string() + ": no rate of the film is given: set tracks.frames_per_second");
    return TrackMateFile(file).read();
}

} // namespace rodwake::store
