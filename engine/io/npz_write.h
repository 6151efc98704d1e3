#pragma once
// NumPy's .npz: a zip of .npy arrays, stored without compression, as numpy.load() reads it.
// Formats: NEP 1 (npy 1.0) and PKWARE's APPNOTE (zip).

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace seldinger {

class NpzWriter {
public:
    /// One-dimensional arrays; names are those of the loaded object's keys.
    void add(const std::string& name, std::span<const double> values);        // float64
    void add(const std::string& name, std::span<const std::int64_t> values);  // int64
    void add(const std::string& name, std::span<const std::string> values);   // fixed-width text, from UTF-8
    /// The file's bytes. @throws Error BadFile beyond the 4 GiB that a plain zip holds
    [[nodiscard]] std::string finish() const;

private:
    struct Entry {
        std::string name, content;  // content: the .npy file
    };
    void add_array(const std::string& name, const std::string& dtype, std::size_t count, std::string_view data);
    std::vector<Entry> entries_;
};

}  // namespace seldinger
