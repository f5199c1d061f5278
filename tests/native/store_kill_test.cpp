// A process that is killed while it saves leaves the old file or the next one, whole.
#include <csignal>

#include <sys/wait.h>
#include <unistd.h>

#include "files.h"
#include "mesoshell/store.h"

namespace mesoshell {
namespace {

bool same(const Map& a, const Map& b)
{
    return a.weights == b.weights && a.eigenmaps == b.eigenmaps && a.sdf == b.sdf && a.rmse == b.rmse;
}

TEST(StoreKill, SaverThatIsKilledLeavesAWholeFile)
{
    const TemporaryFolder folder;
    const std::string path = folder.file("tile.exr");
    const Map maps[2] = {small_map(Precision::single, true, 1), small_map(Precision::single, true, 2)};
    save_map(maps[0], path);
    Random random(6);
    int cut_short = 0;
    for (int round = 0; round < 60; ++round) {
        const pid_t child = fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            for (int i = round;; ++i) {
                save_map(maps[i % 2], path);
            }
        }
        usleep(static_cast<useconds_t>(random.uniform(200.0, 12000.0)));
        ASSERT_EQ(kill(child, SIGKILL), 0);
        int status = 0;
        ASSERT_EQ(waitpid(child, &status, 0), child);
        ASSERT_TRUE(WIFSIGNALED(status)) << "the saver ended by itself";
        const Map loaded = load_map(path);
        ASSERT_TRUE(same(loaded, maps[0]) || same(loaded, maps[1])) << "round " << round;
        // Nothing beside it but what this saver wrote: those before it are gone.
        const std::size_t files = folder.content().size();
        ASSERT_LE(files, 2u);
        cut_short += files == 2 ? 1 : 0;
    }
    EXPECT_GT(cut_short, 0) << "no saver was killed in the middle of it";
    save_map(maps[1], path);
    EXPECT_EQ(folder.content(), std::vector<std::string>{"tile.exr"});
    expect_same_map(load_map(path), maps[1]);
}

TEST(StoreKill, FileThatIsStillBeingWrittenIsNoLeftover)
{
    // Savers to one path, in processes of their own, do not take each other's files away.
    const TemporaryFolder folder;
    const std::string path = folder.file("tile.exr");
    const Map map = small_map(Precision::half, true);
    std::vector<pid_t> children;
    for (int i = 0; i < 4; ++i) {
        const pid_t child = fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            int status = 0;
            try {
                for (int round = 0; round < 30; ++round) {
                    save_map(map, path);
                }
            } catch (const std::exception&) {
                status = 1;
            }
            _exit(status);
        }
        children.push_back(child);
    }
    for (const pid_t child : children) {
        int status = 0;
        ASSERT_EQ(waitpid(child, &status, 0), child);
        EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    }
    expect_same_map(load_map(path), map);
    EXPECT_EQ(folder.content(), std::vector<std::string>{"tile.exr"});
}

}  // namespace
}  // namespace mesoshell
