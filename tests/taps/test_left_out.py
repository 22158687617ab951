from runglight.taps.left_out import LISTED, LeftOut


def test_each_name_once_with_its_count() -> None:
    left_out = LeftOut()
    left_out.add("Load", "is a float")
    left_out.add("Recipe", "is text")
    left_out.add("Load", "is a float")
    assert left_out.sentences() == ["Load: is a float (2 times)", "Recipe: is text"]
    left_out.forget("Load")
    assert left_out.sentences() == ["Recipe: is text"]


def test_endless_names_do_not_fill_the_memory() -> None:
    left_out = LeftOut()
    for number in range(LISTED + 30):
        left_out.add(f"name {number}", "is text")
    assert len(left_out.sentences()) == LISTED + 1
    assert left_out.sentences()[-1] == "and 30 more under further names"
