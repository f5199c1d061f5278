"""The chain mail's geometry under its short name; see tiles/chain.py."""

from tiles.chain import HEIGHT, PERIOD, chain_links, torus  # noqa: F401
