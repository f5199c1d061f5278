// What tells prisms off a ray must never tell off one that the ray runs through.
#include "seen_along.h"

#include "check.h"
#include "mesoshell/render.h"
#include "meshes.h"

namespace mesoshell {
namespace {

// Rays of a torus shell: through its prisms' insides, corners, edges and fins, and past them, from near and far.
TEST(SeenAlong, KeepsEveryPrismThatTheRayRunsThrough)
{
    const Shell shell = torus(1.0f, 0.4f, 12, 8, 5.0f, 3.0f).shell(0.3f);
    Random random(1);
    int through = 0;
    int kept = 0;
    const int count = 200000;
    for (int i = 0; i < count; ++i) {
        const int index = random.below(static_cast<int>(shell.prisms.size()));
        const PrismTexels& prism = shell.prisms[static_cast<std::size_t>(index)];
        glm::vec3 target(0.0f);
        float sum = 0.0f;
        // Weights of 0 and 1 put targets on edges and fins; the last two thirds of rays aim around the prism.
        for (int corner = 0; corner < 6; ++corner) {
            const auto weight = static_cast<float>(i % 2 == 0 ? random.below(2) : random.uniform(0.0, 1.0));
            target += weight * glm::vec3(prism[corner]);
            sum += weight;
        }
        target = sum > 0.0f ? target / sum : glm::vec3(prism[0]);
        if (i % 3 != 0) {
            target += glm::vec3(random.direction() * 0.3);
        }
        glm::vec3 dir = glm::vec3(random.direction());
        if (i % 5 == 0) {
            // Along an edge, but for roundings.
            const glm::vec3 edge(prism[random.below(6)] - prism[random.below(6)]);
            dir = glm::dot(edge, edge) > 0.0f ? glm::normalize(edge) : dir;
        }
        const glm::vec3 origin = target - dir * static_cast<float>(std::pow(10.0, random.uniform(-1.0, 2.0)));
        const bool meets = !prism_spans(prism, origin, dir, 0.0f).empty();
        const bool may_meet = SeenAlong(origin, dir).may_meet(prism);
        through += meets ? 1 : 0;
        kept += may_meet ? 1 : 0;
        ASSERT_TRUE(may_meet || !meets) << i;
    }
    EXPECT_GT(through, count / 4);
    // It tells off most of the others.
    EXPECT_LT(kept - through, (count - through) / 2);
}

}  // namespace
}  // namespace mesoshell
