"use strict";
/* A lesson: six steps, each an arch and a question. */

const lesson = (() => {
  const RIGHT_ANGLE = Math.PI / 2;
  const arch = (change) => ({ halfAngle: RIGHT_ANGLE, mu: 1, eta: 0.15, weight: "centreline", asBuilt: false, ...change });

  /** What is looked at, the question, its answers (the first is right), and why. */
  const STEPS = [
    {
      title: "How thin may it be?",
      text: "This half circle stands: the line of thrust, in which its forces pass from stone to stone, lies within the stones.",
      ask: "How thick must it be at least, over its radius?",
      answers: ["about 11 %", "about 3 %", "about 25 %"],
      why: "At 10.74 % the line of thrust just touches both edges. Thinner, it would leave the stones, and no mortar pulls it back.",
      shown: arch({}), answer: arch({ eta: "least" }),
    },
    {
      title: "How does it fall?",
      text: "The half circle at its least thickness. Move the slider below the picture to the right.",
      ask: "At how many joints does it open?",
      answers: ["5", "2", "3"],
      why: "At both springings, both haunches and the crown. Four hinges make any arch fall; a symmetric one has a fifth.",
      shown: arch({ eta: "least" }), answer: arch({ eta: "least", at: 1 }),
    },
    {
      title: "Flatter arches",
      text: "The same radius, but half the angle: a shallow arch between strong abutments.",
      ask: "Must it be thicker than the half circle, or may it be thinner?",
      answers: ["far thinner", "as thick", "twice as thick"],
      why: "Its least thickness is 0.75 % of the radius, a fourteenth of the half circle's. Its axis is nearer to its line of thrust; but it pushes its abutments apart more.",
      shown: arch({ halfAngle: RIGHT_ANGLE / 2 }), answer: arch({ halfAngle: RIGHT_ANGLE / 2, eta: "least" }),
    },
    {
      title: "Smoother stones",
      text: "The half circle with less friction: 0.35 rather than 1. At its springings it slides outwards.",
      ask: "Does it help to make it thicker?",
      answers: ["yes, 15 % will do", "no, never", "no, it needs more friction"],
      why: "It needs 15.29 %. With friction of 0.3 no thickness suffices: the map shows where its line of equal angle turns upwards.",
      shown: arch({ mu: 0.35, eta: 0.12 }), answer: arch({ mu: 0.35, eta: "least" }),
    },
    {
      title: "Few stones or many",
      text: "The half circle of five stones, as built, at 10 % of its radius: it stands.",
      ask: "And of many thin stones, as thick?",
      answers: ["it falls", "it stands as well", "it stands better"],
      why: "Joints are where it can open. Of five stones it needs 9.66 %, of ever so many 10.74 %.",
      shown: arch({ eta: 0.1, voussoirs: 5, asBuilt: true }), answer: arch({ eta: 0.1 }),
    },
    {
      title: "Twice as large",
      text: "The half circle at 12 % of its radius. Someone builds it twice as large in every direction.",
      ask: "Does the large one stand, too?",
      answers: ["yes", "no, it is eight times as heavy", "only with better stone"],
      why: "All forces grow alike, so the line of thrust keeps its shape: stability is a matter of geometry. Only where stones would crush does size count.",
      shown: arch({ eta: 0.12 }), answer: arch({ eta: 0.12 }),
    },
  ];

  /** Show a step in a section of the page; `look` is told what to look at, `go` where to go. */
  function show(section, number, look, go) {
    section.hidden = !number;
    document.getElementById("learn").hidden = Boolean(number);
    if (!number || section.dataset.step === String(number)) return;
    section.dataset.step = number;
    const step = STEPS[number - 1];
    const part = (name, ...inside) => {
      const made = document.createElement(name);
      made.append(...inside);
      return made;
    };
    const why = part("p");
    why.setAttribute("role", "status");
    const choices = part("p");
    // Each question has its right answer in another place.
    const places = step.answers.map((_, i) => (i + number) % step.answers.length);
    for (const place of places) {
      const choice = part("button", step.answers[place]);
      choice.type = "button";
      choice.addEventListener("click", () => {
        choice.className = place ? "wrong" : "right";
        why.textContent = place ? `Not quite: ${step.answers[0]}. ${step.why}` : `Yes. ${step.why}`;
        look(step.answer);
      });
      choices.append(choice);
    }
    const towards = (words, to) => {
      const button = part("button", words);
      button.type = "button";
      button.addEventListener("click", () => go(to));
      return button;
    };
    const ways = part("p", ...(number > 1 ? [towards("Back", number - 1)] : []),
      ...(number < STEPS.length ? [towards("Next", number + 1)] : []), towards("End the lesson", 0));
    ways.className = "ways";
    const title = part("h2", `${number} of ${STEPS.length}: ${step.title}`);
    section.replaceChildren(title, part("p", step.text), part("p", part("b", step.ask)), choices, why, ways);
  }

  return { show, count: STEPS.length, shown: (number) => STEPS[number - 1].shown };
})();
