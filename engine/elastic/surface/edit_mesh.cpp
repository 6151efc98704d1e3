// The three changes of a surface, collapse, split and flip, with the neighbours of edges.
#include "surface/edit_mesh.h"

#include "core/check.h"

#include <algorithm>

namespace seldinger {

EditMesh::EditMesh(const WallMesh& mesh, const MeshEdges& edges)
{
    from_.reserve(3 * mesh.triangles.size());
    for (const auto& t : mesh.triangles) from_.insert(from_.end(), t.begin(), t.end());
    across_ = opposite_half_edges(mesh, edges);
    out_.assign(mesh.vertices.size(), -1);
    origin_.resize(mesh.vertices.size());
    for (std::size_t v = 0; v < origin_.size(); ++v) origin_[v] = static_cast<std::int32_t>(v);
    std::vector<bool> reached(from_.size(), false);
    for (std::int32_t h = 0; h < half_edge_count(); ++h) {
        if (reached[h]) continue;
        SEL_ASSERT(across_[h] < 0 || from(across_[h]) == to(h));
        std::int32_t v = from_[h];
        if (out_[v] >= 0) {  // another fan has this vertex already
            origin_.push_back(origin_[v]);
            v = static_cast<std::int32_t>(out_.size());
            out_.push_back(-1);
        }
        settle(v, h);
        for_triangles(v, [&](std::int32_t k) { reached[k] = true, from_[k] = v; });
    }
    mark_.assign(out_.size(), 0);
}

int EditMesh::valence(std::int32_t v) const
{
    int count = 0;
    for_neighbours(v, [&](std::int32_t) { ++count; });
    return count;
}

bool EditMesh::joined(std::int32_t v, std::int32_t w) const
{
    bool found = false;
    for_neighbours(v, [&](std::int32_t x) { found |= x == w; });
    return found;
}

void EditMesh::link(std::int32_t g, std::int32_t h)
{
    if (g >= 0) across_[g] = h;
    if (h >= 0) across_[h] = g;
}

void EditMesh::settle(std::int32_t v, std::int32_t h)
{
    const std::int32_t first = h;
    while (across_[h] >= 0) {
        h = next(across_[h]);
        if (h == first) break;
    }
    out_[v] = h;
}

bool EditMesh::can_collapse(std::int32_t h)
{
    const std::int32_t a = from(h), b = to(h), g = across_[h];
    if (g >= 0 && on_rim(a) && on_rim(b)) return false;  // would pinch the sheet
    ++stamp_;
    for_neighbours(a, [&](std::int32_t w) { mark_[w] = stamp_; });
    int common = 0;
    for_neighbours(b, [&](std::int32_t w) { common += mark_[w] == stamp_; });
    if (common != (g >= 0 ? 2 : 1)) return false;
    // the corners across lose an edge: inside 3 must be left, which also keeps the last tetrahedron; on a rim 2
    const auto can_lose = [&](std::int32_t c) { return valence(c) > (on_rim(c) ? 2 : 3); };
    return can_lose(apex(h)) && (g < 0 || can_lose(apex(g)));
}

void EditMesh::collapse(std::int32_t h)
{
    const std::int32_t a = from(h), b = to(h), c = apex(h), g = across_[h];
    const std::int32_t d = g >= 0 ? apex(g) : -1;
    for_triangles(b, [&](std::int32_t k) { from_[k] = a; });
    // at c: neighbours over b-c and c-a meet; at d in the same way
    const std::int32_t over_bc = across_[next(h)], over_ca = across_[previous(h)];
    link(over_bc, over_ca);
    std::int32_t leaves_a = over_ca >= 0 ? over_ca : next(over_bc);
    const std::int32_t leaves_c = over_bc >= 0 ? over_bc : next(over_ca);
    std::int32_t leaves_d = -1;
    if (g >= 0) {
        const std::int32_t over_ad = across_[next(g)], over_db = across_[previous(g)];
        link(over_ad, over_db);
        leaves_d = over_ad >= 0 ? over_ad : next(over_db);
    }
    for (const std::int32_t dead : {h, g})
        if (dead >= 0)
            for (std::int32_t k = dead - dead % 3, e = 0; e < 3; ++e) from_[k + e] = across_[k + e] = -1;
    out_[b] = -1;
    settle(a, leaves_a);
    settle(c, leaves_c);
    if (d >= 0) settle(d, leaves_d);
}

std::int32_t EditMesh::split(std::int32_t h)
{
    const std::int32_t g = across_[h], m = vertex_count();
    out_.push_back(-1);
    mark_.push_back(0);
    // the triangle a b c of half-edge k keeps a m c; m b c is new. @return m -> b
    const auto divide = [&](std::int32_t k) {
        const std::int32_t b = to(k), c = apex(k), bc = next(k), over = across_[bc];
        const std::int32_t mb = half_edge_count();
        from_.insert(from_.end(), {m, b, c});
        across_.insert(across_.end(), {-1, -1, -1});
        from_[bc] = m;
        link(mb + 1, over);
        link(mb + 2, bc);
        if (out_[b] == bc) out_[b] = mb + 1;
        return mb;
    };
    const std::int32_t mb = divide(h);
    out_[m] = mb;
    if (g >= 0) {
        const std::int32_t ma = divide(g);
        link(h, ma);
        link(mb, g);
    }
    return m;
}

bool EditMesh::can_flip(std::int32_t h) const
{
    const std::int32_t g = across_[h];
    if (g < 0 || joined(apex(h), apex(g))) return false;
    // both ends lose an edge
    const auto can_lose = [&](std::int32_t v) { return valence(v) > 3; };
    return can_lose(from(h)) && can_lose(to(h));
}

void EditMesh::flip(std::int32_t h)
{
    const std::int32_t g = across_[h], hn = next(h), hp = previous(h), gn = next(g), gp = previous(g);
    const std::int32_t a = from(h), b = to(h), c = apex(h), d = apex(g);
    const std::int32_t bc = across_[hn], ca = across_[hp], ad = across_[gn], db = across_[gp];
    // a b c + b a d  ->  d c a + c d b
    from_[h] = d, from_[hn] = c, from_[hp] = a;
    from_[g] = c, from_[gn] = d, from_[gp] = b;
    link(hn, ca);
    link(hp, ad);
    link(gn, db);
    link(gp, bc);
    if (out_[a] == h || out_[a] == gn) out_[a] = hp;
    if (out_[b] == g || out_[b] == hn) out_[b] = gp;
    if (out_[c] == hp) out_[c] = hn;
    if (out_[d] == gp) out_[d] = gn;
}

std::vector<std::int32_t> EditMesh::compact()
{
    std::vector<std::int32_t> vertex(out_.size(), -1), triangle(from_.size() / 3, -1);
    std::int32_t vertices = 0, triangles = 0;
    for (std::size_t v = 0; v < out_.size(); ++v)
        if (out_[v] >= 0) vertex[v] = vertices++;
    for (std::size_t t = 0; t < triangle.size(); ++t)
        if (from_[3 * t] >= 0) triangle[t] = triangles++;
    const auto moved = [&](std::int32_t h) { return h < 0 ? -1 : 3 * triangle[h / 3] + h % 3; };
    for (std::size_t h = 0; h < from_.size(); ++h) {
        const std::int32_t to = moved(static_cast<std::int32_t>(h));
        if (triangle[h / 3] < 0) continue;
        from_[to] = vertex[from_[h]];
        across_[to] = moved(across_[h]);
    }
    from_.resize(3 * static_cast<std::size_t>(triangles));
    across_.resize(from_.size());
    for (std::size_t v = 0; v < out_.size(); ++v)
        if (vertex[v] >= 0) out_[vertex[v]] = moved(out_[v]);
    out_.resize(vertices);
    mark_.assign(out_.size(), 0);
    return vertex;
}

std::vector<std::array<std::int32_t, 3>> EditMesh::triangles() const
{
    std::vector<std::array<std::int32_t, 3>> result;
    result.reserve(from_.size() / 3);
    for (std::size_t h = 0; h < from_.size(); h += 3) result.push_back({from_[h], from_[h + 1], from_[h + 2]});
    return result;
}

}  // namespace seldinger
