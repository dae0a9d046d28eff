// Tracks from GSD files of the schema hoomd.

#include "frame_rows.hpp"
#include "gsd_format.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <span>

namespace rodwake::store {

namespace {

/// The container: chunks by name and frame. Whatever points beyond the file is an InputError.
class GsdFile {
public:
    explicit GsdFile(const std::filesystem::path& path)
        : path_(path.string()), in_(path, std::ios::binary), size_(std::filesystem::file_size(path)) {
        const auto head = read<GsdHeader>(0, 1, "its header").front();
        if (head.magic != GsdHeader::magic_number)
            fail("is no GSD file: it does not begin as one");
        if (const std::uint32_t major = head.gsd_version >> 16; major > 2)
            fail(fmt::format("is of GSD {}, and versions up to 2 are known; write it with an older gsd",
                             major));
        if (!std::string(head.schema.data(), head.schema.size()).starts_with("hoomd"))
            fail("is not of the schema hoomd, which has positions of particles");
        index_ = read<GsdEntry>(head.index_location, head.index_entries, "its index");
        const auto end = std::ranges::find(index_, 0, &GsdEntry::location);
        index_.erase(end, index_.end());
        std::ranges::stable_sort(index_, {}, &GsdEntry::frame);
        if (index_.empty())
            fail("has no frames");
        read_names(head);
    }

    [[noreturn]] void fail(const std::string& what) const { throw InputError(path_ + ": " + what); }

    const std::vector<GsdEntry>& index() const { return index_; }
    std::uintmax_t size() const { return size_; }

    std::uint16_t number_of(const std::string& name) const {
        const auto found = names_.find(name);
        return found == names_.end() ? 0xFFFF : found->second;
    }

    /// All numbers of a chunk.
    std::vector<double> numbers(const GsdEntry& chunk) const {
        switch (static_cast<GsdType>(chunk.type)) {
        case GsdType::u8:
            return as<std::uint8_t>(chunk);
        case GsdType::u16:
            return as<std::uint16_t>(chunk);
        case GsdType::u32:
            return as<std::uint32_t>(chunk);
        case GsdType::u64:
            return as<std::uint64_t>(chunk);
        case GsdType::i8:
            return as<std::int8_t>(chunk);
        case GsdType::i16:
            return as<std::int16_t>(chunk);
        case GsdType::i32:
            return as<std::int32_t>(chunk);
        case GsdType::i64:
            return as<std::int64_t>(chunk);
        case GsdType::f32:
            return as<float>(chunk);
        case GsdType::f64:
            return as<double>(chunk);
        }
        fail(fmt::format("frame {}: a chunk of unknown type {}: the index is damaged", chunk.frame,
                         chunk.type));
    }

private:
    template<class T>
    std::vector<T> read(std::uint64_t from, std::uint64_t count, const std::string& what) const {
        if (from > size_ || count > (size_ - from) / sizeof(T))
            fail(fmt::format(
                "{} of {} x {} bytes at byte {} lies beyond its end, byte {}: the file is cut short "
                "or damaged",
                what, count, sizeof(T), from, size_));
        std::vector<T> values(static_cast<std::size_t>(count));
        in_.clear();
        in_.seekg(static_cast<std::streamoff>(from));
        in_.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(T)));
        if (!in_ && count > 0)
            fail(fmt::format("{} at byte {} cannot be read", what, from));
        return values;
    }

    template<class T>
    std::vector<double> as(const GsdEntry& chunk) const {
        if (chunk.columns == 0 || chunk.rows > size_ / chunk.columns)
            fail(fmt::format("frame {}: a chunk of {} x {} numbers: the index is damaged", chunk.frame,
                             chunk.rows, chunk.columns));
        const std::vector<T> values =
            read<T>(static_cast<std::uint64_t>(chunk.location), chunk.rows * chunk.columns,
                    fmt::format("a chunk of frame {}", chunk.frame));
        return {values.begin(), values.end()};
    }

    /// Of version 1 in slots of 64 bytes, of version 2 one behind the other.
    void read_names(const GsdHeader& head) {
        const auto slots =
            read<std::array<char, gsd_name_size>>(head.names_location, head.names_entries, "its names");
        std::string text;
        for (const auto& slot : slots)
            text.append(slot.data(), slot.size());
        const bool in_slots = head.gsd_version >> 16 < 2;
        for (std::size_t at = 0; at < text.size() && text[at] != '\0' && names_.size() < 0xFFFF;) {
            const std::string name = text.c_str() + at;
            names_.emplace(name, static_cast<std::uint16_t>(names_.size()));
            at += in_slots ? gsd_name_size : name.size() + 1;
        }
    }

    std::string path_;
    mutable std::ifstream in_;
    std::uintmax_t size_;
    std::vector<GsdEntry> index_;
    std::map<std::string, std::uint16_t> names_;
};

/// What the schema says of a frame: what is not there is as in the first frame.
class GsdTracks {
public:
    GsdTracks(const std::filesystem::path& path, const TrackColumns& given)
        : path_(path.string()), given_(given), file_(path),
          out_(given, [this] { return fmt::format("{}: frame {}", path_, frame_); }) {}

    TrackRows read(const TrackProgress& on_progress) {
        const std::vector<GsdEntry>& index = file_.index();
        for (std::size_t from = 0; from < index.size();) {
            std::size_t to = from;
            while (to < index.size() && index[to].frame == index[from].frame)
                ++to;
            now_ = std::span(index).subspan(from, to - from);
            if (from == 0)
                first_ = now_;
            frame_ = now_.front().frame;
            frame();
            from = to;
            if (!on_progress(static_cast<double>(to) / static_cast<double>(index.size())))
                break;
        }
        return out_.take(path_);
    }

private:
    /// Of this frame, else of the first; null if neither has it.
    const GsdEntry* chunk(const std::string& name, std::size_t rows = 0) const {
        const std::uint16_t number = file_.number_of(name);
        for (const auto& entries : {now_, first_})
            if (const auto found = std::ranges::find(entries, number, &GsdEntry::name);
                number != 0xFFFF && found != entries.end()) {
                if (rows == 0 || found->rows == rows)
                    return &*found;
                if (found->frame == frame_)
                    out_.fail(fmt::format("{} has {} rows, expected {}: the index is damaged", name,
                                          found->rows, rows));
            }
        return nullptr;
    }

    /// Numbers of a chunk with `columns` columns, or none.
    std::vector<double> table(const std::string& name, std::size_t rows, std::uint32_t columns) const {
        const GsdEntry* found = chunk(name, rows);
        if (found && found->columns != columns)
            out_.fail(fmt::format("{} has {} columns, expected {}", name, found->columns, columns));
        return found ? file_.numbers(*found) : std::vector<double>{};
    }

    std::size_t count(const std::string& name) const {
        const std::vector<double> number = table(name, 1, 1);
        return number.empty() || !(number[0] >= 0.0 && number[0] < 0x1p53)
                   ? 0
                   : static_cast<std::size_t>(number[0]);
    }

    void frame() {
        const std::vector<double> time = table("log/time", 1, 1);
        out_.begin(static_cast<std::int64_t>(count("configuration/step")),
                   time.empty() ? std::nullopt : std::optional(time.front()));
        const std::vector<double> box = table("configuration/box", 6, 1);
        if (!box.empty())
            out_.box({box[0], box[1], true, box[3] != 0.0 || box[4] != 0.0 || box[5] != 0.0});
        const std::size_t particles = count("particles/N");
        if (particles == 0)
            return;
        const std::vector<double> place = table("particles/position", particles, 3);
        if (place.empty())
            out_.fail(fmt::format(
                "no particles/position of its {} particles: the file is cut short or damaged", particles));
        read_ += place.size() * sizeof(float);
        if (chunk("particles/position")->frame == frame_ && read_ > 2 * file_.size())
            out_.fail("chunks of particles/position lie one over the other: the index is damaged");
        const std::vector<double> type = table("particles/typeid", particles, 1),
                                  turned = table("particles/orientation", particles, 4);
        const std::vector<bool> rods = rod_types();
        for (std::size_t i = 0; i < particles; ++i) {
            std::optional<double> heading;
            if (!turned.empty())
                heading = heading_of(&turned[4 * i]);
            const double of = type.empty() ? 0.0 : type[i];
            out_.add({}, place[3 * i], place[3 * i + 1], heading,
                     of >= 0.0 && of < static_cast<double>(rods.size()) &&
                         rods[static_cast<std::size_t>(of)]);
        }
    }

    /// Of the x axis of a body, turned by a quaternion with its real part first.
    static double heading_of(const double* q) {
        return std::atan2(2.0 * (q[0] * q[3] + q[1] * q[2]), 1.0 - 2.0 * (q[2] * q[2] + q[3] * q[3]));
    }

    std::vector<bool> rod_types() const {
        const GsdEntry* found = chunk("particles/types");
        if (!found)
            return {names_rod(given_, "A")};
        const std::vector<double> letters = file_.numbers(*found);
        std::vector<bool> rods;
        for (std::size_t row = 0; row < found->rows; ++row) {
            std::string name;
            for (std::size_t k = 0; k < found->columns && letters[row * found->columns + k] != 0.0; ++k)
                name += static_cast<char>(static_cast<int>(letters[row * found->columns + k]));
            rods.push_back(names_rod(given_, name));
        }
        return rods;
    }

    std::string path_;
    const TrackColumns& given_;
    GsdFile file_;
    FrameRows out_;
    std::span<const GsdEntry> now_, first_;
    std::uint64_t frame_ = 0;
    std::uintmax_t read_ = 0;
};

} // namespace

TrackRows read_gsd_tracks(const std::filesystem::path& file, const TrackColumns& columns,
                          const TrackProgress& on_progress) {
    return GsdTracks(file, columns).read(on_progress);
}

} // namespace rodwake::store
