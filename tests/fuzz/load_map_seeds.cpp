// Writes the small maps that fuzzing begins with into the folder given.
#include "files.h"
#include "mesoshell/store.h"

int main(int count, char** arguments)
{
    if (count != 2) {
        return 2;
    }
    for (const auto precision : {mesoshell::Precision::half, mesoshell::Precision::single}) {
        for (const bool with_sdf : {false, true}) {
            const std::string name = std::string(precision == mesoshell::Precision::half ? "half" : "float") + (with_sdf ? "_sdf" : "");
            mesoshell::save_map(mesoshell::small_map(precision, with_sdf), std::string(arguments[1]) + "/" + name + ".exr");
        }
    }
    return 0;
}
