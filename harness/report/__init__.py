"""One page about a machine for a colleague: verdict first, how sure, and how to do it again."""
