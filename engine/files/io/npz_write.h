#pragma once
// NumPy's .npz: a zip of .npy arrays, stored without compression, as numpy.load() reads it.
// Formats: NEP 1 (npy 1.0) and PKWARE's APPNOTE (zip).

#include "core/folder.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace seldinger {

class NpzWriter {
public:
    /// Names are those of the loaded object's keys. Arrays have one dimension unless a shape is given.
    void add(const std::string& name, std::span<const double> values);        // float64
    /// The last index varies fastest; `shape` multiplies to the number of values.
    void add(const std::string& name, std::span<const double> values, const std::vector<std::size_t>& shape);
    void add(const std::string& name, std::span<const std::int64_t> values);  // int64
    void add(const std::string& name, std::span<const std::string> values);   // fixed-width text, from UTF-8
    /// The file's bytes. @throws Error BadFile beyond the 4 GiB that a plain zip holds
    [[nodiscard]] std::string finish() const;

private:
    struct Entry {
        std::string name, content;  // content: the .npy file
    };
    void add_array(const std::string& name, const std::string& dtype, const std::vector<std::size_t>& shape,
                   std::string_view data);
    std::vector<Entry> entries_;
};

/// A .npy of float32 numbers.
/// @param shape  e.g. {rows, columns}; its product is the number of values. The file appears only when it is complete.
/// @throws Error BadFile
void write_npy(const FilePlace& place, std::span<const float> values, const std::vector<std::size_t>& shape);

}  // namespace seldinger
