"""Style of pictures: width of a page, sizes of text, colours."""

WIDTH = 8.6  # [in]
BODY_SIZE, SMALL_SIZE, HEADING_SIZE = 9.0, 7.5, 12.0  # [pt]

# Okabe and Ito's colours, told apart by readers with any kind of colour vision.
INK, GREY, FAINT, PAPER = "#222222", "#6b6b6b", "#b8b8b8", "#f1f1ef"
BLUE, VERMILION, GREEN = "#0072B2", "#D55E00", "#009E73"
PRESSURE_MAP = "YlOrRd"
TORQUE_MAP = "viridis"
