"use strict";
(() => {
  const config = {
    responsive: true,
    displaylogo: false,
    showSendToCloud: false,
    plotlyServerURL: "",
    modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"],
    toImageButtonOptions: { format: "svg" },
  };
  const draw = (element) => {
    const figure = FIGURES[element.id];
    Plotly.newPlot(element, figure.data, figure.layout, config);
  };
  // Drawing what is out of sight would keep the head of the page waiting.
  const watcher = new IntersectionObserver(
    (entries) => {
      for (const entry of entries) {
        if (!entry.isIntersecting) continue;
        watcher.unobserve(entry.target);
        draw(entry.target);
      }
    },
    { rootMargin: "1200px" },
  );
  const plots = document.querySelectorAll(".plot");
  plots.forEach((element) => watcher.observe(element));
  // A printed page shows every figure.
  window.addEventListener("beforeprint", () =>
    plots.forEach((element) => element.data || draw(element)),
  );
})();
