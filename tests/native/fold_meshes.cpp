#include "fold_meshes.h"

#include <algorithm>
#include <cmath>

#include "check.h"

namespace mesoshell {

SurfaceMesh joined(const SurfaceMesh& a, const SurfaceMesh& b)
{
    SurfaceMesh mesh = a;
    mesh.positions.insert(mesh.positions.end(), b.positions.begin(), b.positions.end());
    mesh.face_sizes.insert(mesh.face_sizes.end(), b.face_sizes.begin(), b.face_sizes.end());
    mesh.uvs.insert(mesh.uvs.end(), b.uvs.begin(), b.uvs.end());
    for (const std::int32_t corner : b.corners) {
        mesh.corners.push_back(corner + static_cast<std::int32_t>(a.positions.size()));
    }
    mesh.normals.clear();
    return mesh;
}

SurfaceMesh facing_plates(float distance, int cells)
{
    const SurfaceMesh low = flat_grid(cells, cells, 1.0f, 1.0f);
    SurfaceMesh high = low;
    for (glm::vec3& p : high.positions) {
        p = glm::vec3(p.x, 1.0f - p.y, distance);
    }
    return joined(low, high);
}

SurfaceMesh valley(float angle, int cells)
{
    SurfaceMesh mesh = flat_grid(2 * cells, cells, 2.0f, 1.0f);
    const float half = 0.5f * angle;
    for (glm::vec3& p : mesh.positions) {
        const float arm = p.x - 1.0f;
        p = glm::vec3(arm * std::sin(half), p.y, std::abs(arm) * std::cos(half));
    }
    mesh.normals.clear();
    return mesh;
}

SurfaceMesh bumpy(int levels, float amount, unsigned seed)
{
    SurfaceMesh mesh = round_octahedron(levels);
    Random random(seed);
    for (glm::vec3& p : mesh.positions) {
        p *= static_cast<float>(random.uniform(1.0 - amount, 1.0 + amount));
    }
    mesh.normals.clear();
    return mesh;
}

SurfaceMesh sockets(int levels)
{
    SurfaceMesh head = round_octahedron(levels);
    const glm::vec3 eyes[2] = {glm::normalize(glm::vec3(0.4f, 0.2f, 1.0f)), glm::normalize(glm::vec3(-0.4f, 0.2f, 1.0f))};
    for (glm::vec3& p : head.positions) {
        for (const glm::vec3& eye : eyes) {
            const float off = glm::length(p - eye) / 0.3f;
            p *= 1.0f - 0.35f * std::exp(-off * off * off * off);
        }
    }
    head.normals.clear();
    SurfaceMesh all = head;
    for (const glm::vec3& eye : eyes) {
        SurfaceMesh ball = round_octahedron(std::max(1, levels - 2));
        for (glm::vec3& p : ball.positions) {
            p = 0.16f * p + 0.9f * eye;
        }
        all = joined(all, ball);
    }
    return all;
}

SurfaceMesh spikes(int levels)
{
    SurfaceMesh mesh = round_octahedron(levels);
    for (std::size_t i = 0; i < mesh.positions.size(); i += 7) {
        mesh.positions[i] *= 2.5f;
    }
    mesh.normals.clear();
    return mesh;
}

}  // namespace mesoshell
