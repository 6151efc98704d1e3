#pragma once
// Control meshes made by hand for tests of the elastic wall.

#include "vessel/wall_mesh.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>

namespace seldinger::test {

inline constexpr double pi = std::numbers::pi;

/// Grid of nu x nv squares on [0,1]^2, each cut in two, mapped by `place`; joined end to end along u when `round`. `alternate`
/// turns every second diagonal (valences 4 and 8).
inline WallMesh grid(int nu, int nv, const std::function<Vec3(double, double)>& place, bool round = false, bool alternate = false)
{
    WallMesh mesh;
    const int row = round ? nu : nu + 1;
    for (int j = 0; j <= nv; ++j)
        for (int i = 0; i < row; ++i) mesh.vertices.push_back(place(double(i) / nu, double(j) / nv));
    const auto at = [&](int i, int j) { return j * row + (round ? i % nu : i); };
    for (int j = 0; j < nv; ++j)
        for (int i = 0; i < nu; ++i) {
            const int a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
            if (alternate && (i + j) % 2) {
                mesh.triangles.push_back({a, b, d});
                mesh.triangles.push_back({b, c, d});
            } else {
                mesh.triangles.push_back({a, b, c});
                mesh.triangles.push_back({a, c, d});
            }
        }
    return mesh;
}

/// Radius 10, with a hole of 18 degrees at its pole.
inline WallMesh hemisphere_mesh(int n)
{
    return grid(
        4 * n, n,
        [](double u, double v) {
            const double a = 2 * pi * u, b = v * 72 * pi / 180;
            return Vec3(10 * std::cos(a) * std::cos(b), 10 * std::sin(a) * std::cos(b), 10 * std::sin(b));
        },
        true);
}

/// Tube of radius R about z from -length/2 to length/2, normals inwards, `around` vertices in each of along + 1 rings, every
/// second ring turned by half a facet so that triangles are nearly equilateral.
inline WallMesh tube(double radius, double length, int around, int along)
{
    WallMesh mesh;
    for (int j = 0; j <= along; ++j)
        for (int i = 0; i < around; ++i) {
            const double a = 2 * pi * (i + 0.5 * (j % 2)) / around;
            mesh.vertices.push_back({radius * std::cos(a), radius * std::sin(a), length * (double(j) / along - 0.5)});
        }
    for (int j = 0; j < along; ++j)
        for (int i = 0; i < around; ++i) {
            const int a = j * around + i, b = j * around + (i + 1) % around;
            const int c = (j + 1) * around + i, d = (j + 1) * around + (i + 1) % around;
            if (j % 2 == 0) {  // the ring above is turned: c lies between a and b
                mesh.triangles.push_back({a, c, b});
                mesh.triangles.push_back({b, c, d});
            } else {
                mesh.triangles.push_back({a, d, b});
                mesh.triangles.push_back({a, c, d});
            }
        }
    return mesh;
}

/// Flips about `share` of the inner edges where both new triangles stay well shaped and valences stay within 5 to 7 (rims: 2 to 4
/// triangles): a mesh as decimation leaves it.
inline void flip_edges(WallMesh& mesh, double share, unsigned seed)
{
    std::mt19937 random(seed);
    std::vector<int> about(mesh.vertices.size(), 0);
    for (const auto& t : mesh.triangles)
        for (int v : t) ++about[v];
    std::map<std::pair<int, int>, int> owner;  // directed edge -> triangle
    const auto add = [&](int t) {
        for (int e = 0; e < 3; ++e) owner[{mesh.triangles[t][e], mesh.triangles[t][(e + 1) % 3]}] = t;
    };
    const auto drop = [&](int t) {
        for (int e = 0; e < 3; ++e) owner.erase({mesh.triangles[t][e], mesh.triangles[t][(e + 1) % 3]});
    };
    for (int t = 0; t < int(mesh.triangles.size()); ++t) add(t);
    const auto third = [&](int t, int a, int b) {
        for (int v : mesh.triangles[t])
            if (v != a && v != b) return v;
        return -1;
    };
    const auto smallest_angle = [&](int a, int b, int c) {
        double best = 4;
        const int v[3] = {a, b, c};
        for (int k = 0; k < 3; ++k) {
            const Vec3 p = mesh.vertices[v[(k + 1) % 3]] - mesh.vertices[v[k]],
                       q = mesh.vertices[v[(k + 2) % 3]] - mesh.vertices[v[k]];
            best = std::min(best, std::atan2(p.cross(q).norm(), p.dot(q)));
        }
        return best;
    };
    const int wanted = int(share * 1.5 * double(mesh.triangles.size()));
    for (int done = 0, tries = 0; done < wanted && tries < 40 * wanted; ++tries) {
        const int t = int(random() % mesh.triangles.size()), e = int(random() % 3);
        const int a = mesh.triangles[t][e], b = mesh.triangles[t][(e + 1) % 3];
        const auto other = owner.find({b, a});
        if (other == owner.end()) continue;
        const int s = other->second, c = third(t, a, b), d = third(s, a, b);
        if (owner.count({c, d}) || owner.count({d, c}) || about[a] <= 5 || about[b] <= 5 || about[c] >= 7 || about[d] >= 7)
            continue;
        if (smallest_angle(a, d, c) < 0.45 || smallest_angle(d, b, c) < 0.45) continue;
        drop(t), drop(s);
        mesh.triangles[t] = {a, d, c}, mesh.triangles[s] = {d, b, c};
        add(t), add(s);
        --about[a], --about[b], ++about[c], ++about[d], ++done;
    }
}

/// Octahedron subdivided and put on a sphere, normals outwards; valence 4 at six vertices.
inline WallMesh ball(double radius, int levels)
{
    WallMesh mesh;
    mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<int, int>, int> middles;
        std::vector<std::array<std::int32_t, 3>> finer;
        for (const auto& t : mesh.triangles) {
            std::array<std::int32_t, 3> m;
            for (int e = 0; e < 3; ++e) {
                const auto key = std::minmax(t[e], t[(e + 1) % 3]);
                const auto [it, fresh] = middles.insert({{key.first, key.second}, int(mesh.vertices.size())});
                if (fresh) mesh.vertices.push_back((mesh.vertices[key.first] + mesh.vertices[key.second]).normalized());
                m[e] = it->second;
            }
            finer.push_back({t[0], m[0], m[2]});
            finer.push_back({m[0], t[1], m[1]});
            finer.push_back({m[2], m[1], t[2]});
            finer.push_back({m[0], m[1], m[2]});
        }
        mesh.triangles = finer;
    }
    for (Vec3& x : mesh.vertices) x *= radius;
    return mesh;
}

}  // namespace seldinger::test
