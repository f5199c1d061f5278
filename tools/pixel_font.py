"""Capital letters of 5 by 7 pixels, for labels in pictures that no library writes for us."""

from __future__ import annotations

import numpy as np

# Glyphs side by side, six columns each, the sixth empty.
BANDS = {
    "ABCDEFGHIJKLM": """
 ###  ####   ###  ####  ##### #####  ###  #   #  ###    ### #   # #     #   #
#   # #   # #   # #   # #     #     #   # #   #   #      #  #  #  #     ## ##
#   # #   # #     #   # #     #     #     #   #   #      #  # #   #     # # #
##### ####  #     #   # ####  ####  # ### #####   #      #  ##    #     # # #
#   # #   # #     #   # #     #     #   # #   #   #      #  # #   #     #   #
#   # #   # #   # #   # #     #     #   # #   #   #   #  #  #  #  #     #   #
#   # ####   ###  ####  ##### #      #### #   #  ###   ##   #   # ##### #   #""",
    "NOPQRSTUVWXYZ": """
#   #  ###  ####   ###  ####   #### ##### #   # #   # #   # #   # #   # #####
##  # #   # #   # #   # #   # #       #   #   # #   # #   # #   # #   #     #
# # # #   # #   # #   # #   # #       #   #   # #   # #   #  # #   # #     #
# # # #   # ####  #   # ####   ###    #   #   # #   # # # #   #     #     #
#  ## #   # #     # # # # #       #   #   #   # #   # # # #  # #    #    #
#   # #   # #     #  #  #  #      #   #   #   #  # #  ## ## #   #   #   #
#   #  ###  #      ## # #   # ####    #    ###    #   #   # #   #   #   #####""",
    "0123456789": """
 ###    #    ###  #####    #  #####   ##  #####  ###   ###
#   #  ##   #   #    #    ##  #      #        # #   # #   #
#  ##   #       #   #    # #  ####  #        #  #   # #   #
# # #   #     ##     #  #  #      # ####    #    ###   ####
##  #   #    #        # #####     # #   #   #   #   #     #
#   #   #   #     #   #    #  #   # #   #   #   #   #    #
 ###   ###  #####  ###     #   ###   ###    #    ###   ##""",
    ".,-+%/():<>=": """
                        ##             #   #             #   #
                    #   ##  #     #   #     #    ##     #     #
                    #      #     #   #       #   ##    #       #  #####
            ##### #####   #     #    #       #        #         #
       ##           #    #     #     #       #   ##    #       #  #####
 ##    ##           #   #  ## #       #     #    ##     #     #
 ##    #                   ##          #   #             #   #""",
}


def _glyphs() -> dict[str, np.ndarray]:
    glyphs = {" ": np.zeros((7, 5), bool)}
    for letters, drawn in BANDS.items():
        lines = [line.ljust(6 * len(letters)) for line in drawn.split("\n")[1:]]
        band = np.array([[mark == "#" for mark in line] for line in lines])
        for number, letter in enumerate(letters):
            glyphs[letter] = band[:, 6 * number:6 * number + 5]
    return glyphs


GLYPHS = _glyphs()


def text_mask(text: str, scale: int = 1) -> np.ndarray:
    """The text in capitals, bool [7 scale, 6 scale len(text)], the top row first; KeyError for a letter without a glyph."""
    if not text:
        return np.zeros((7 * scale, 0), bool)
    columns = [np.pad(GLYPHS[letter], ((0, 0), (0, 1))) for letter in text.upper()]
    return np.kron(np.concatenate(columns, axis=1), np.ones((scale, scale), bool)).astype(bool)


def draw_text(picture: np.ndarray, text: str, left: int, top: int, color, scale: int = 1) -> None:
    """Writes the text into picture [h, w, 3]; what does not fit is cut off."""
    place = picture[top:top + 7 * scale, left:left + 6 * scale * len(text)]
    place[text_mask(text, scale)[:place.shape[0], :place.shape[1]]] = color
