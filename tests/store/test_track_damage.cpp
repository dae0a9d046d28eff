// CSV of tracks, damaged at random: read and put in order, or an InputError; never a crash, a hang or memory
// beyond measure. [.long] does it 10^5 times.

#include "scratch.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/measure/tracks.hpp"
#include "rodwake/store/track_file.hpp"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <cstring>
#include <random>
#include <sys/resource.h>

using namespace rodwake;
using namespace store_test;

namespace {

using Random = std::mt19937;

/// One of: bytes changed, the end cut, a piece doubled or taken out, a number replaced.
void damage(std::string& text, Random& random) {
    const auto below = [&](std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(random()) % n; };
    const std::size_t from = below(text.size()), length = below(1 + below(200));
    switch (random() % 6) {
    case 0:
        text.resize(from);
        break;
    case 1:
        text.insert(below(text.size()), text.substr(from, length));
        break;
    case 2:
        text.erase(from, length);
        break;
    case 3: { // a number of the text
        const char* const numbers[] = {"-1",
                                       "1e999",
                                       "99999999999999999999",
                                       "nan",
                                       "",
                                       "0",
                                       "1e-320",
                                       "9007199254740991",
                                       "2.5",
                                       "-0",
                                       "1e15",
                                       "inf",
                                       "0x10",
                                       "1000000"};
        const std::size_t at = text.find_first_of("0123456789", from);
        if (at != text.npos)
            text.replace(at, text.find_first_not_of("0123456789.", at) - at,
                         numbers[below(std::size(numbers))]);
        break;
    }
    case 4: { // a word of 8 bytes
        const std::uint64_t words[] = {0,
                                       1,
                                       0xFF,
                                       0xFFFFFFFF,
                                       ~std::uint64_t{0},
                                       std::uint64_t{1} << 40,
                                       std::uint64_t{1} << 63,
                                       0x7FF8000000000000};
        const std::uint64_t word = words[below(std::size(words))];
        if (text.size() > 8)
            std::memcpy(text.data() + below(text.size() / 4) * 4 % (text.size() - 8), &word, 1 + below(8));
        break;
    }
    default:
        for (std::size_t n = 1 + below(4); n > 0 && !text.empty(); --n)
            text[below(text.size())] = static_cast<char>(random() % 256);
    }
}

const std::string csv_film =
    "frame,particle,x,y\n0,4,1,2\n0,5,3,2.5\n1,4,1.25,2\n1,5,9.5,2.5\n2,4,1.5,2\n2,5,9,2.5\n";

struct Outcomes {
    int read = 0, refused = 0;
};

/// As `rodwake run` does it: reads, puts in order, looks at each frame.
void use(const fs::path& file) {
    TrackRows rows = store::read_track_csv(file, {}, [](double) { return true; });
    REQUIRE(rows.id.size() == rows.x.size());
    REQUIRE(rows.frame.size() + rows.time.size() == rows.size());
    REQUIRE((rows.heading.empty() || rows.heading.size() == rows.size()));
    REQUIRE((rows.is_rod.empty() || rows.is_rod.size() == rows.size()));
    measure::TrackScale scale{1.0, 1.0, 0.4, rows.box, {}};
    const measure::Tracks tracks = measure::ordered_tracks(std::move(rows), scale, file.string());
    std::size_t frames = 0;
    measure::for_each_frame(tracks, 1, [&](const measure::Frame&, double) { return ++frames < 1000; });
    REQUIRE(frames > 1);
}

Outcomes damaged(int times, unsigned seed) {
    const Scratch scratch;
    Random random(seed);
    Outcomes found;
    for (int k = 0; k < times; ++k) {
        std::string text = csv_film;
        for (auto n = 1 + random() % 3; n > 0; --n)
            damage(text, random);
        fs::remove(scratch / "film.csv"); // a file that is written over goes to the disk at once
        const fs::path file = scratch.file("film.csv", text);
        try {
            use(file);
            ++found.read;
        } catch (const InputError& error) {
            REQUIRE(has(error.what(), "film.csv"));
            ++found.refused;
        }
    }
    return found;
}

/// MB, the most that this program has had.
double most_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

} // namespace

TEST_CASE("Damaged files of tracks are read or refused, and nothing else") {
    const Outcomes found = damaged(400, 1);
    CHECK(found.read > 0);
    CHECK(found.refused > 10);
}

// RODWAKE_DAMAGE_SEED: other damage; RODWAKE_DAMAGE_TIMES: not 10^5.
TEST_CASE("A file of tracks damaged 10^5 times", "[.long]") {
    const char* seed = std::getenv("RODWAKE_DAMAGE_SEED");
    const char* times = std::getenv("RODWAKE_DAMAGE_TIMES");
    const Outcomes found =
        damaged(times ? std::atoi(times) : 100000, seed ? static_cast<unsigned>(std::atoi(seed)) : 2);
    WARN(found.read << " read, " << found.refused << " refused, " << most_memory() << " MB at most");
    CHECK(most_memory() < 1500.0); // a film of 10^7 frames, hardly any with rows, is refused
}
