#pragma once
// Energy at the detector before it is read.

#include <cstddef>
#include <vector>

namespace seldinger {

/// Per pixel, as shares of the open beam.
struct Exposure {
    int columns = 0, rows = 0;
    std::vector<float> signal;  // energy over the open beam's, I/I_0
    std::vector<float> second;  // sum of squared energies over the open beam's energy and the mean energy of its photons; of one
                                // energy the same as signal

    void resize(int width, int height)
    {
        columns = width, rows = height;
        signal.resize(static_cast<std::size_t>(width) * height);
        second.resize(signal.size());
    }
};

}  // namespace seldinger
