#pragma once
// Structs as bytes and back. Each lists its parts once, with names; writing, reading and a hash of the layout
// follow, so that bytes of another layout are refused and never misread:
//
//     template<>
//     inline constexpr auto parts<Pose> = parts_of("x y", &Pose::x, &Pose::y);
//
// Parts stand in the order of the members; one that is left out does not compile.

#include "rodwake/store/bytes.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <string>
#include <tuple>
#include <vector>

namespace rodwake::store {

template<class... Members>
struct Parts {
    std::string_view names; ///< "x y z"
    std::tuple<Members...> members;
};

template<class Record, class... Members>
consteval Parts<Members Record::*...> parts_of(std::string_view names, Members Record::*... members) {
    if (std::ranges::count(names, ' ') + 1 != sizeof...(members))
        throw "each part has a name";
    std::size_t end = 0;
    const auto lay = [&end](std::size_t size, std::size_t align) {
        end = (end + align - 1) / align * align + size;
    };
    (lay(sizeof(Members), alignof(Members)), ...);
    lay(0, alignof(Record));
    if (end != sizeof(Record))
        throw "a member of this struct is not among its parts";
    return {names, {members...}};
}

/// Specialised for each struct that is kept.
template<class T>
inline constexpr Parts<> parts{};

template<class T>
concept InParts = !std::is_same_v<std::remove_const_t<decltype(parts<T>)>, Parts<>>;

/// How one type is kept. Numbers and enumerations: their bytes.
template<class T>
struct Kept {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>, "list the parts of this struct");
    static void put(ByteWriter& out, const T& value) { out.put(value); }
    static void get(ByteReader& in, T& value) { value = in.get<T>(); }
    static std::string layout() {
        return (std::is_floating_point_v<T> ? "f"
                : std::is_signed_v<T>       ? "i"
                                            : "u") +
               std::to_string(sizeof(T));
    }
};

template<InParts T>
struct Kept<T> {
    /// call(Kept of the part, its value) for each.
    template<class Value, class Call>
    static void each(Value& value, const Call& call) {
        const auto item = [&](auto& part) { call(Kept<std::remove_cvref_t<decltype(part)>>{}, part); };
        std::apply([&](const auto... members) { (item(value.*members), ...); }, parts<T>.members);
    }
    static void put(ByteWriter& out, const T& value) {
        each(value, [&](auto kept, const auto& part) { kept.put(out, part); });
    }
    static void get(ByteReader& in, T& value) {
        each(value, [&](auto kept, auto& part) { kept.get(in, part); });
    }
    static std::string layout() {
        std::string text(parts<T>.names);
        T any{};
        each(any, [&](auto kept, const auto&) { text += "," + kept.layout(); });
        return "{" + text + "}";
    }
};

template<>
struct Kept<std::string> {
    static void put(ByteWriter& out, const std::string& value) { out.put_text(value); }
    static void get(ByteReader& in, std::string& value) { value = in.get_text(); }
    static std::string layout() { return "text"; }
};

template<>
struct Kept<Eigen::Vector3d> {
    static void put(ByteWriter& out, const Eigen::Vector3d& value) {
        out.put(std::array{value.x(), value.y(), value.z()});
    }
    static void get(ByteReader& in, Eigen::Vector3d& value) {
        const auto [x, y, z] = in.get<std::array<double, 3>>();
        value = {x, y, z};
    }
    static std::string layout() { return "xyz"; }
};

template<>
struct Kept<Eigen::Quaterniond> {
    static void put(ByteWriter& out, const Eigen::Quaterniond& value) {
        out.put(std::array{value.w(), value.x(), value.y(), value.z()});
    }
    static void get(ByteReader& in, Eigen::Quaterniond& value) {
        const auto [w, x, y, z] = in.get<std::array<double, 4>>();
        value = {w, x, y, z};
    }
    static std::string layout() { return "wxyz"; }
};

template<class T, std::size_t N>
struct Kept<std::array<T, N>> {
    static void put(ByteWriter& out, const std::array<T, N>& values) {
        for (const T& value : values)
            Kept<T>::put(out, value);
    }
    static void get(ByteReader& in, std::array<T, N>& values) {
        for (T& value : values)
            Kept<T>::get(in, value);
    }
    static std::string layout() { return std::to_string(N) + "*" + Kept<T>::layout(); }
};

template<class T>
struct Kept<std::vector<T>> {
    static void put(ByteWriter& out, const std::vector<T>& values) {
        if constexpr (std::is_arithmetic_v<T>) {
            out.put_array(values);
        } else {
            out.put(std::uint64_t{values.size()});
            for (const T& value : values)
                Kept<T>::put(out, value);
        }
    }
    static void get(ByteReader& in, std::vector<T>& values) {
        if constexpr (std::is_arithmetic_v<T>) {
            values = in.get_array<T>();
        } else {
            values.clear();
            for (auto left = in.get<std::uint64_t>(); left > 0;
                 --left) // a wrong number ends where the bytes do
                Kept<T>::get(in, values.emplace_back());
        }
    }
    static std::string layout() { return "[" + Kept<T>::layout() + "]"; }
};

/// The lower half of XXH3-64 of the layout's text: names and types of all parts.
std::uint32_t layout_hash(const std::string& layout);

template<class T>
std::vector<std::byte> to_bytes(const T& value) {
    ByteWriter out;
    Kept<T>::put(out, value);
    return out.take();
}

/// Throws InputError for bytes that end early or late.
template<class T>
T from_bytes(std::span<const std::byte> bytes, const std::string& file) {
    ByteReader in(bytes, file);
    T value{};
    Kept<T>::get(in, value);
    in.finish();
    return value;
}

} // namespace rodwake::store
