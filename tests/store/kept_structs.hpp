#pragma once
// Structs with their parts, for the tests of archive.hpp.

#include "rodwake/store/archive.hpp"

#include <array>
#include <string>
#include <vector>

namespace store_test {

struct Pose {
    std::array<double, 2> place{};
    float heading = 0.0F;
    bool is_held = false;
    bool operator==(const Pose&) const = default;
};

struct Poses { // the same numbers, one by another name
    std::array<double, 2> place{};
    float heading = 0.0F;
    bool is_free = false;
};

struct Kept {
    std::string name;
    Eigen::Vector3d push = Eigen::Vector3d::Zero();
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
    std::vector<Pose> poses;
    std::vector<double> times;
};

} // namespace store_test

namespace rodwake::store {

template<>
inline constexpr auto parts<store_test::Pose> = parts_of("place heading is_held", &store_test::Pose::place,
                                                         &store_test::Pose::heading,
                                                         &store_test::Pose::is_held);
template<>
inline constexpr auto parts<store_test::Poses> = parts_of("place heading is_free", &store_test::Poses::place,
                                                          &store_test::Poses::heading,
                                                          &store_test::Poses::is_free);
template<>
inline constexpr auto parts<store_test::Kept> = parts_of("name push turn poses times",
                                                         &store_test::Kept::name, &store_test::Kept::push,
                                                         &store_test::Kept::turn, &store_test::Kept::poses,
                                                         &store_test::Kept::times);

} // namespace rodwake::store
