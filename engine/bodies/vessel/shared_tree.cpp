// Keeps the latest tree, by the content of its mesh.
#include "vessel/shared_tree.h"

#include "core/content_hash.h"

#include <mutex>
#include <utility>

namespace seldinger {
namespace {

struct MeshContent {
    std::size_t vertices = 0;
    ContentHash places, triangles;
    bool operator==(const MeshContent&) const = default;
};

template <class T>
ContentHash hash_of_list(const std::vector<T>& list)
{
    return content_hash({reinterpret_cast<const char*>(list.data()), list.size() * sizeof(T)});
}

MeshContent content_of(const WallMesh& mesh)
{
    return {mesh.vertices.size(), hash_of_list(mesh.vertices), hash_of_list(mesh.triangles)};
}

/// The tree, or once it has been shrunk its division, and the tree as long as others have it.
struct Kept {
    std::mutex mutex;
    MeshContent content;
    std::shared_ptr<const WallTree> tree;
    std::weak_ptr<const WallTree> others;
    TreeDivision division;

    void set(const MeshContent& of, std::shared_ptr<const WallTree> made)
    {
        tree = std::move(made);
        content = of;
        others.reset();
        division = {};
    }
    std::shared_ptr<const WallTree> find(const WallMesh& mesh, const MeshContent& of)
    {
        if (!(content == of)) return nullptr;
        if (tree) return tree;
        if (std::shared_ptr<const WallTree> alive = others.lock()) return alive;
        std::optional<WallTree> again = divided_wall_tree(mesh, division);
        if (again) set(of, std::make_shared<const WallTree>(std::move(*again)));
        return tree;
    }
};

Kept& kept()
{
    static Kept latest;
    return latest;
}

}  // namespace

std::shared_ptr<const WallTree> shared_wall_tree(const WallMesh& mesh)
{
    const MeshContent content = content_of(mesh);
    const std::lock_guard lock(kept().mutex);  // a second thread waits for the tree instead of making its own
    if (std::shared_ptr<const WallTree> found = kept().find(mesh, content)) return found;
    kept().set({}, nullptr);  // its memory goes first
    kept().set(content, std::make_shared<const WallTree>(build_wall_tree(mesh)));
    return kept().tree;
}

void keep_wall_tree(const WallMesh& mesh, WallTree tree)
{
    const MeshContent content = content_of(mesh);
    const std::lock_guard lock(kept().mutex);
    kept().set(content, std::make_shared<const WallTree>(std::move(tree)));
}

void shrink_kept_wall_tree()
{
    const std::lock_guard lock(kept().mutex);
    if (!kept().tree) return;
    kept().division = division_of(*kept().tree);
    kept().others = kept().tree;
    kept().tree = nullptr;
}

}  // namespace seldinger
