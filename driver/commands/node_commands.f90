module node_commands
  !! FEAP (header) and COORdinates.
  !!
  !! Differences from FEAP: after its coordinates a node may have a weight (1 if none is given);
  !! counts of 0 are counted.
  use kinds, only: wp
  use messages, only: message_log, whole_text
  use deck_record, only: record
  use deck_reader, only: deck_type => deck
  use model_data, only: model_type
  use mesh_draft, only: draft_type
  use data_lines, only: next_line, mesh_command
  implicit none (type, external)
  private
  public :: read_header, read_coordinates

  integer, parameter :: largest_node = 20000000   !! a greater number is a slip, and no memory holds it

contains

  subroutine read_header(deck, model, draft, log, good)
    !! The line after `FEAP * * title`: `numnp numel nummat ndm ndf nen`.
    type(deck_type), intent(inout) :: deck
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    logical, intent(out) :: good              !! the mesh can be read
    type(record) :: rec
    integer :: n(6), i

    good = .false.
    model%title = deck%title
    call deck%next_command(rec, log)
    rec%command = 'FEAP'
    draft%header = rec%at
    if (rec%end_of_deck) then
      if (log%error_count() == 0) call rec%add_error(log, 'the deck ends after its first line', &
        'The counts numnp numel nummat ndm ndf nen follow, for example 0 0 0 2 2')
      return
    end if
    if (rec%count < 4 .or. mesh_command(rec%word(1)) > 0) then
      call rec%add_error(log, 'expected the line numnp numel nummat ndm ndf nen', &
        'For example 0 0 0 2 2 (counts of 0 are counted)')
      if (mesh_command(rec%word(1)) > 0) call deck%push_back(rec)
      return
    end if
    n = 0
    do i = 1, min(6, rec%count)
      call rec%integer(i, n(i), log, 'numnp numel nummat ndm ndf nen', 0)
      if (n(i) < 0) call rec%add_error(log, 'a count cannot be negative', '', i)
    end do
    if (n(4) /= 2 .and. n(4) /= 3) then
      call rec%add_error(log, 'the space dimension ndm (4th number) is ' // whole_text(n(4)), &
        'It is 2 or 3')
      return
    end if
    draft%numnp = n(1)
    draft%numel = n(2)
    draft%nummat = n(3)
    model%ndm = n(4)
    model%ndf = n(5)
    if (model%ndf == 0) model%ndf = model%ndm
    good = .true.
  end subroutine read_header

  subroutine read_coordinates(deck, model, draft, log)
    !! Records `n ng x1 .. xndm [w]`: from node n to that of the next record, nodes n+ng, n+2ng, ...
    !! lie on a line.
    type(deck_type), intent(inout) :: deck
    type(model_type), intent(in) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(record) :: rec
    integer :: n, ng, n_old, ng_old
    real(wp) :: x(model%ndm), w, x_old(model%ndm), w_old
    logical :: more

    n_old = 0
    ng_old = 0
    x_old = 0
    w_old = 1
    do
      call next_line(deck, rec, log, more)
      if (.not. more) exit
      if (rec%is_damaged) cycle
      call rec%check_count(2 + model%ndm, 3 + model%ndm, log, &
        'node, increment, coordinates, weight')
      call rec%integer(1, n, log, 'node number')
      call rec%integer(2, ng, log, 'increment', 0)
      x = 0
      if (rec%count >= 2 + model%ndm) call rec%numbers(3, x, log, 'coordinates')
      call rec%number(3 + model%ndm, w, log, 'weight', 1.0_wp)
      if (n < 1) then
        if (n < 0 .or. rec%word(1) == '0') &
          call rec%add_error(log, 'node numbers begin with 1', '', 1)
        n_old = 0
        cycle
      end if
      if (n > largest_node) then
        call rec%add_error(log, 'the node number ' // whole_text(n) // ' is too large', 'Numbers go up to ' // &
          whole_text(largest_node) // ' and have no gaps', 1)
        n_old = 0
        cycle
      end if
      call define(n, x, w)
      if (n_old > 0 .and. ng_old /= 0) call generate()
      n_old = n
      ng_old = ng
      x_old = x
      w_old = w
    end do
    if (ng_old /= 0) call log%add_error(draft%last_at, 'COORdinates', &
      'the last record has an increment', &
      'Nodes are generated up to the next record: give it, or write 0')

  contains

    subroutine define(a, xa, wa)
      integer, intent(in) :: a
      real(wp), intent(in) :: xa(:), wa

      draft%last_at = rec%at
      if (a <= draft%nn) then
        if (draft%defined(a)) then
          call rec%add_error(log, 'node ' // whole_text(a) // ' is defined twice', &
            'Nodes of patches follow those before; explicit nodes go first')
          return
        end if
      end if
      call draft%set_node(a, xa, wa)
    end subroutine define

    subroutine generate()
      !! Nodes between n_old and n.
      integer :: a, steps, k
      real(wp) :: part

      if (mod(n - n_old, ng_old) /= 0 .or. (n - n_old)/ng_old < 1) then
        call rec%add_error(log, 'node ' // whole_text(n) // ' cannot be reached from ' // &
          whole_text(n_old) // &
          ' in steps of ' // whole_text(ng_old), 'Correct the increment of the record before')
        return
      end if
      steps = (n - n_old)/ng_old
      do k = 1, steps - 1
        a = n_old + k*ng_old
        part = real(k, wp)/steps
        call define(a, x_old + part*(x - x_old), w_old + part*(w - w_old))
      end do
    end subroutine generate
  end subroutine read_coordinates
end module node_commands
