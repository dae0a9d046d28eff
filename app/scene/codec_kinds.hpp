#pragma once
// What the codecs have in common: one of single values (codecs.cpp), one of lists and tables
// (codec_lists.cpp).

#include "codec.hpp"
#include "diagnostics.hpp"

namespace rodwake::scene {

/// What a type T takes: how it is read, printed and described, and what differs from this base.
template<class T>
struct As;

template<class T>
struct Single {
    static constexpr bool is_quantity = false;
    static constexpr int depth = 0;
    static void clear(T&) {}
    static bool is_present(const T&) { return true; }
    static std::string misses(const Key&, const T&, std::span<const PathSegment>) { return ""; }
    static bool set(const Input& in, T& value, std::span<const PathSegment>) {
        return As<T>::read(in, value);
    }
};

template<class T>
struct Quantified : Single<T> {
    static constexpr bool is_quantity = true;
};

/// Nothing in it can be set without text.
template<class T>
struct Whole : Single<T> {
    static constexpr int depth = -1;
};

/// A number in range; a string with a unit where there are units.
bool quantity(const Input& in, double& value);
/// Null with a diagnostic unless it is a word, and one of `names` if there are some.
const std::string* word_of(const Input& in, Names names);
/// The two numbers that `in` lists.
bool two_sides(const Input& in, double& x, double& y);

/// The same, of a value whose type the visitor does not know.
template<class T>
class TypedCodec : public Codec {
public:
    void clear(void* value) const override { As<T>::clear(of(value)); }
    bool is_present(const void* value) const override { return As<T>::is_present(of(value)); }
    bool parse(const Input& in, void* value) const override { return As<T>::read(in, of(value)); }
    std::string print(const Key& key, const void* value, const Units& units) const override {
        return As<T>::text(key, of(value), units);
    }
    Description describe(const Key& key, const void* value) const override {
        Description all = As<T>::about(key, of(value));
        if (key.is_required)
            all.fallback = "required";
        if (all.has_range)
            all.legal = key.range.text();
        return all;
    }
    bool is_quantity() const override { return As<T>::is_quantity; }
    int depth() const override { return As<T>::depth; }
    std::string misses(const Key& key, const void* value, std::span<const PathSegment> path) const override {
        return As<T>::misses(key, of(value), path);
    }
    bool set(const Input& in, void* value, std::span<const PathSegment> path) const override {
        return As<T>::set(in, of(value), path);
    }

private:
    static T& of(void* value) { return *static_cast<T*>(value); }
    static const T& of(const void* value) { return *static_cast<const T*>(value); }
};

template<class T>
const Codec& codec_of() {
    static const TypedCodec<T> codec;
    return codec;
}

// Of the items of lists: in codecs.cpp.
extern template const Codec& codec_of<double>();
extern template const Codec& codec_of<long>();
extern template const Codec& codec_of<Value>();
extern template const Codec& codec_of<std::string>();

} // namespace rodwake::scene
