"""The viewer: every control, key and gesture does what it says."""

import numpy as np
import pytest
from made_results import make_rows, write_images, write_results
from opened_page import PHONE, WIDE, Opened, browser, opened, report  # noqa: F401

from tools.report.exr_image import read_exr, rgb
from tools.report.report import main
from tools.report.file_names import dump_names, file_name_of

STATE = "JSON.parse(document.getElementById('report-data').textContent)"


def srgb(image, exposure):
    exposed = np.clip(np.asarray(image, float) * 2.0 ** exposure, 0.0, 1.0)
    return 255.0 * np.where(exposed <= 0.0031308, 12.92 * exposed, 1.055 * exposed ** (1 / 2.4) - 0.055)


def press(page, key):
    page.locator("#stage").focus()
    page.keyboard.press(key)
    page.wait_for_timeout(60)


def captions(page):
    return page.locator("#stage figcaption").all_text_contents()


def test_three_panes_use_the_width_and_are_named_by_method(opened):
    opened.open_images()
    assert captions(opened.page) == ["A: uniform + box", "B: multiscale + directional", "reference"]
    boxes = [c.bounding_box() for c in opened.page.locator("#stage canvas").all()]
    area = opened.page.locator("#images").bounding_box()
    assert boxes[2]["x"] + boxes[2]["width"] - boxes[0]["x"] > 0.95 * area["width"]
    assert len({(box["width"], box["height"], box["y"]) for box in boxes}) == 1
    assert boxes[0]["height"] / boxes[0]["width"] == pytest.approx(40 / 48, rel=0.01)  # nothing is left empty


@pytest.mark.parametrize("size", [(40, 40), (30, 60)], ids=["square", "portrait"])
def test_square_and_portrait_pictures_fill_their_panes(browser, tmp_path, size):
    rows = make_rows(dumps=("a.spool",), samplers=("uniform",), budgets=(4,), size=size)
    write_results(tmp_path, rows)
    write_images(tmp_path, rows, dump_names(["a.spool"]), file_name_of)
    assert main([str(tmp_path), "-o", str(tmp_path / "a.html")]) == 0
    opened = Opened(browser, tmp_path / "a.html")
    opened.open_images()
    box = opened.page.locator("#stage canvas").first.bounding_box()
    assert box["height"] / box["width"] == pytest.approx(size[1] / size[0], rel=0.02)
    assert box["height"] <= WIDE["height"]
    reference = rgb(read_exr(tmp_path / "a_reference.exr"))
    data = opened.page.evaluate(STATE)
    exposure = data["pictures"]["scenes"][0]["exposure"]
    for x, y in ((0, 0), (size[0] - 1, size[1] - 1)):
        seen = opened.colour_at((x + 0.15) / size[0], (y + 0.15) / size[1], 2)
        assert np.abs(np.array(seen) - srgb(reference[y, x], exposure)).max() <= 2.0


def test_panes_show_the_values_of_the_exr_files_and_exposure_is_shared(opened, made_folder):
    opened.open_images()
    page = opened.page
    exposure = page.evaluate(STATE)["pictures"]["scenes"][0]["exposure"]
    images = [rgb(read_exr(made_folder / "chess_uniform_box_16spp" / "estimate.exr")),
              rgb(read_exr(made_folder / "chess_multiscale_directional_16spp" / "estimate.exr")),
              rgb(read_exr(made_folder / "chess_reference.exr"))]
    for change in (0.0, 0.5):
        for pane, image in enumerate(images):
            seen = opened.colour_at(40.5 / 48, 5.5 / 40, pane)
            assert np.abs(np.array(seen) - srgb(image[5, 40], exposure + change)).max() <= 2.0
        press(page, "e")


def test_flip_keys_and_tabs(opened):
    opened.open_images()
    page = opened.page
    for key, caption in (("a", "A: uniform + box"), ("b", "B: multiscale + directional"), ("r", "reference"),
                         ("1", "A: uniform + box"), ("Space", "B: multiscale + directional"), ("Space", "A: uniform + box")):
        press(page, key)
        assert captions(page) == [caption]
    page.locator(".tabs button", has_text="reference").click()
    page.wait_for_timeout(150)
    assert captions(page) == ["reference"]
    assert page.locator(".tabs button").all_text_contents() == ["uniform + box", "multiscale + directional", "reference"]
    page.get_by_role("button", name="side by side").click()
    page.wait_for_timeout(150)
    assert len(captions(page)) == 3


def test_zoom_and_pan_are_linked_and_end_at_the_border(opened, made_folder):
    opened.open_images()
    page = opened.page
    before = [opened.picture(i) for i in range(3)]
    for _ in range(8):
        press(page, "+")
    after = [opened.picture(i) for i in range(3)]
    assert all(a != b for a, b in zip(after, before))
    for _ in range(30):
        press(page, "ArrowLeft")
        press(page, "ArrowUp")
    exposure = page.evaluate(STATE)["pictures"]["scenes"][0]["exposure"]
    corner = rgb(read_exr(made_folder / "chess_reference.exr"))[0, 0]
    assert np.abs(np.array(opened.colour_at(0.02, 0.02, 2)) - srgb(corner, exposure)).max() <= 2.0
    press(page, "0")
    assert [opened.picture(i) for i in range(3)] == before


def test_the_split_slider_divides_one_pane(opened):
    opened.open_images()
    page = opened.page
    whole = [opened.colour_at(0.26, 0.91, 0), opened.colour_at(0.76, 0.91, 1)]
    page.get_by_role("button", name="split").click()
    page.wait_for_timeout(200)
    assert captions(page) == ["A: uniform + box  |  B: multiscale + directional"]
    assert [opened.colour_at(0.26, 0.91), opened.colour_at(0.76, 0.91)] == whole
    page.locator("#split-slider").evaluate("s => { s.value = 0.9; s.dispatchEvent(new Event('input')); }")
    assert opened.colour_at(0.76, 0.91) != whole[1]
    box = page.locator("#stage canvas").bounding_box()
    x, y = box["x"] + 0.9 * box["width"], box["y"] + 20
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.5 * box["width"], y, steps=4)
    page.mouse.up()
    assert float(page.locator("#split-slider").input_value()) == pytest.approx(0.5, abs=0.02)


def test_layers_are_maps_with_their_bar_on_the_picture(opened):
    opened.open_images()
    page = opened.page
    pictures = {opened.picture()}
    names = page.locator("button[data-group=layer]").all_text_contents()
    assert names == ["image", "error", "FLIP", "difference", "density", "size", "direction"]
    assert "rgb =" not in page.locator("main").inner_text() and "vec3" not in page.locator("main").inner_text()
    for name in names[1:]:
        page.get_by_role("button", name=name, exact=True).click()
        page.wait_for_timeout(200)
        pictures.add(opened.picture(1))
        width = page.locator("#stage canvas").nth(1).evaluate("c => c.width")
        bar = {tuple(opened.colour_at((8 + 0.05 * i * min(0.6 * width, 220)) / width, 1 - 24 / page.locator(
            "#stage canvas").nth(1).bounding_box()["height"], 1)) for i in range(20)}
        assert len(bar) > 6, name
    assert len(pictures) == len(names)
    press(page, ",")
    assert page.locator("button[data-value=size]").get_attribute("aria-pressed") == "true"
    press(page, ".")
    assert page.locator("button[data-value=direction]").get_attribute("aria-pressed") == "true"


def test_the_budget_slider_keeps_the_methods(opened, made_folder):
    opened.open_images()
    page = opened.page
    slider = page.locator("#budget-slider")
    assert slider.evaluate("s => s.nextElementSibling.textContent") == "16 spp"
    first = opened.picture(1)
    press(page, "[")
    assert slider.evaluate("s => s.nextElementSibling.textContent") == "8 spp"
    assert captions(page)[1] == "B: multiscale + directional" and opened.picture(1) != first
    slider.evaluate("s => { s.value = 2; s.dispatchEvent(new Event('input')); }")
    page.wait_for_timeout(200)
    assert opened.picture(1) == first


def test_every_choice_of_recording_and_method_changes_the_pictures(opened):
    opened.open_images()
    page = opened.page
    seen = {opened.picture()}
    page.locator("#viewer-a-sampler").select_option(label="mitchell")
    page.locator("#viewer-a-filter").select_option(label="gaussian")
    page.wait_for_timeout(200)
    seen.add(opened.picture())
    assert captions(page)[0] == "A: mitchell + gaussian"
    page.locator("#viewer-scene").select_option(label="kitchen")
    page.wait_for_timeout(200)
    assert captions(page)[0] == "A: mitchell + gaussian"
    page.locator("#viewer-b-sampler").select_option(label="uniform")
    page.locator("#viewer-b-filter").select_option(label="box")
    page.wait_for_timeout(200)
    assert captions(page)[1] == "B: uniform + box"
    assert opened.errors == []


def test_insets_stand_where_the_methods_differ_and_move(browser, tmp_path):
    from exr_writing import write_exr
    from made_results import planes
    rows = make_rows(dumps=("a.spool",), samplers=("uniform", "multiscale"), filters=("box",), budgets=(4,), size=(60, 48))
    write_results(tmp_path, rows)
    write_images(tmp_path, rows, dump_names(["a.spool"]), file_name_of)
    reference = rgb(read_exr(tmp_path / "a_reference.exr"))
    for sampler in ("uniform", "multiscale"):
        image = np.array(reference)
        if sampler == "uniform":
            image[30:36, 44:50] *= 3.0
        write_exr(tmp_path / f"a_{sampler}_box_4spp" / "estimate.exr", planes(image))
    assert main([str(tmp_path), "-o", str(tmp_path / "a.html")]) == 0
    opened = Opened(browser, tmp_path / "a.html")
    opened.open_images()
    page = opened.page
    insets = page.locator(".inset")
    assert insets.count() == 2 and insets.first.locator("canvas").count() == 3
    first = insets.first.locator("canvas").evaluate_all("all => all.map(c => c.toDataURL())")
    assert first[0] != first[1] and first[1] == first[2]  # B is the reference itself, A differs there
    unit = page.locator("#stage canvas").first.bounding_box()
    x, y = unit["x"] + 47.5 / 60 * unit["width"], unit["y"] + 33.5 / 48 * unit["height"]
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 20 / 60 * unit["width"], y, steps=5)
    page.mouse.up()
    moved = page.locator(".inset").first.locator("canvas").evaluate_all("all => all.map(c => c.toDataURL())")
    assert moved[0] == moved[1]  # twenty pixels to the left they agree
    page.locator(".inset").first.focus()
    for _ in range(20):
        page.keyboard.press("ArrowRight")
    back = page.locator(".inset").first.locator("canvas").evaluate_all("all => all.map(c => c.toDataURL())")
    assert back[0] != back[1]
    assert opened.errors == []


def test_a_finger_drags_the_picture_once_it_is_enlarged(browser, report):
    context = browser.new_context(offline=True, viewport=PHONE, has_touch=True)
    page = context.new_page()
    page.goto(report.as_uri())
    page.locator("#images").scroll_into_view_if_needed()
    page.wait_for_selector("#stage[data-ready]", timeout=60000)
    canvas = page.locator("#stage canvas")
    assert canvas.count() == 1 and canvas.bounding_box()["width"] > 0.9 * PHONE["width"]
    assert canvas.evaluate("c => getComputedStyle(c).touchAction") == "pan-y"  # the page scrolls over it
    for _ in range(4):
        press(page, "+")
    assert canvas.evaluate("c => getComputedStyle(c).touchAction") == "none"
    before = canvas.evaluate("c => c.toDataURL()")
    canvas.evaluate("""canvas => {
      canvas.setPointerCapture = () => {};
      const send = (name, x, y) => canvas.dispatchEvent(new PointerEvent(name, {pointerId: 7, pointerType: 'touch',
        bubbles: true, clientX: x, clientY: y}));
      send('pointerdown', 60, 60); send('pointermove', 90, 90); send('pointerup', 90, 90);
    }""")
    assert canvas.evaluate("c => c.toDataURL()") != before


def test_a_pixel_under_the_cursor_tells_its_values(opened, made_folder):
    opened.open_images()
    page = opened.page
    box = page.locator("#stage canvas").first.bounding_box()
    page.mouse.move(box["x"] + 10.5 / 48 * box["width"], box["y"] + 20.5 / 40 * box["height"])
    page.wait_for_timeout(100)
    text = page.locator("#pixel-values").text_content()
    assert text.startswith("x 10, y 20:")
    value = rgb(read_exr(made_folder / "chess_reference.exr"))[20, 10]
    shown = [float(v) for v in text.split("R ")[1].split()]
    assert shown == pytest.approx(list(value), rel=6e-3)


def test_pictures_of_512_appear_soon_and_keep_to_their_memory(browser, tmp_path):
    rows = make_rows(dumps=("big.spool",), samplers=("uniform", "multiscale"), filters=("box", "directional"),
                     budgets=(4, 8), replicates=2, size=(512, 512))
    write_results(tmp_path, rows)
    write_images(tmp_path, rows, dump_names(["big.spool"]), file_name_of)
    assert main([str(tmp_path), "-o", str(tmp_path / "a.html"), "--max-image-mb", "80"]) == 0
    assert (tmp_path / "a.html").stat().st_size < 84e6
    opened = Opened(browser, tmp_path / "a.html")
    opened.open_images()
    page = opened.page
    ready = page.evaluate("performance.now()")
    assert ready < 20000, ready  # a machine that is shared by many
    for layer in ("error", "FLIP", "density", "size", "direction", "image"):
        page.get_by_role("button", name=layer, exact=True).click()
        page.wait_for_timeout(300)
    used = page.evaluate("performance.memory.usedJSHeapSize")
    assert used < 400e6, used
    assert opened.errors == []
