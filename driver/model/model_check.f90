module model_check
  !! What can be wrong with a model as a whole: weights, missing coordinates, inverted elements,
  !! nodes without elements. Every finding names the data set that it comes from.
  use kinds, only: wp
  use status_codes, only: ok, bad_extraction, inverted_element, node_out_of_range, status_text
  use messages, only: message_log, deck_place, whole_text
  use number_text, only: write_number
  use model_data, only: model_type
  use model_sets, only: used_nodes
  use mesh_draft, only: draft_type
  use gauss_rules, only: gauss_legendre, tensor_rule
  use rational_basis, only: shape_functions
  use geometry_map, only: physical_gradient
  use surface_frame, only: tangent_frame_at
  implicit none (type, external)
  private
  public :: check_dimensions, check_mesh, check_nodes, check_geometry, switch_off_unused

contains

  subroutine check_mesh(model, draft, log)
    !! Connectivities, degrees and operators fit and name existing nodes.
    type(model_type), intent(in) :: model
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log
    integer :: e, k, status, told
    integer, parameter :: most = 20

    if (model%mesh%ne == 0) then
      call log%add_error(draft%header, 'FEAP', 'the mesh has no elements', &
        'Give some by PATCh, BEZIer or ELEMents before END')
      return
    end if
    told = 0
    do e = 1, model%mesh%ne
      associate (ix => model%mesh%nodes(model%mesh%node_ptr(e):model%mesh%node_ptr(e + 1) - 1))
        do k = 1, size(ix)
          if (ix(k) >= 1 .and. ix(k) <= model%nn) cycle
          told = told + 1
          if (told <= most) call log%add_error(draft%element_place(e), draft%element_name(e), &
            'element ' // &
            whole_text(e) // ' has node ' // whole_text(ix(k)) // ', which does not exist', &
            'Nodes are numbered from 1 to ' // whole_text(model%nn))
          exit
        end do
      end associate
    end do
    if (told > 0) return
    call model%mesh%check(model%nn, status, e)
    if (status /= ok) call log%add_error(draft%element_place(e), draft%element_name(e), &
      'element ' // &
      whole_text(e) // ': ' // status_text(status), '')
  end subroutine check_mesh

  subroutine check_nodes(model, draft, log)
    !! Nodes that elements use have coordinates and positive weights.
    type(model_type), intent(in) :: model
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log
    logical, allocatable :: told(:)
    integer :: a, e, k
    character(:), allocatable :: fact

    allocate (told(model%nn), source=.false.)
    fact = ''
    do e = 1, model%mesh%ne
      do k = model%mesh%node_ptr(e), model%mesh%node_ptr(e + 1) - 1
        a = model%mesh%nodes(k)
        if (told(a)) cycle
        if (.not. draft%defined(a)) then
          fact = 'node ' // whole_text(a) // ' of element ' // whole_text(e) // &
            ' has no coordinates'
          call log%add_error(draft%element_place(e), draft%element_name(e), fact, &
            'Give them by COORdinates')
          told(a) = .true.
        else if (.not. model%w(a) > 0) then
          fact = 'node ' // whole_text(a) // ' of element ' // whole_text(e) // &
            ' has the weight ' // &
            write_number(model%w(a))
          call log%add_error(draft%element_place(e), draft%element_name(e), fact, &
            'Weights must be positive')
          told(a) = .true.
        end if
      end do
    end do
  end subroutine check_nodes

  subroutine check_dimensions(model, draft, log)
    !! The material of an element is made for its parametric dimension. One message for each data set.
    type(model_type), intent(in) :: model
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log
    integer :: e, i, made_for

    do i = 1, size(draft%origins)
      do e = max(draft%origins(i)%first, 1), draft%origins(i)%last
        made_for = model%materials(model%material_of(e))%element%dp
        if (made_for == 0 .or. made_for == model%mesh%dp(e)) cycle
        call log%add_error(draft%element_place(e), draft%element_name(e), 'element ' // whole_text(e) // ' has ' // &
          whole_text(model%mesh%dp(e)) // ' parametric directions, its material ' // &
          whole_text(model%materials(model%material_of(e))%number) // ' is made for ' // whole_text(made_for), &
          'Surfaces in space take SHELl, bodies SOLId')
        exit
      end do
    end do
  end subroutine check_dimensions

  subroutine check_geometry(model, draft, log)
    !! det J is positive at Gauss points and not negative at corners (where it may vanish: collapsed
    !! edges); surfaces have an area, and their normal does not turn round within an element. One message for each data set.
    type(model_type), intent(in) :: model
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log
    type(deck_place) :: at
    integer :: e, i, first, bad, status, first_status
    real(wp) :: detj, place(model%ndm), worst, worst_place(model%ndm)
    character(:), allocatable :: fact, remedy

    fact = ''
    remedy = ''
    do i = 1, size(draft%origins)
      bad = 0
      first = 0
      first_status = ok
      worst = 0
      worst_place = 0
      do e = draft%origins(i)%first, draft%origins(i)%last
        if (e == 0) exit
        if (model%mesh%dp(e) /= model%ndm .and. model%mesh%dp(e) /= model%ndm - 1) then
          call log%add_error(draft%element_place(e), draft%element_name(e), 'element ' // &
            whole_text(e) // &
            ' has ' // whole_text(model%mesh%dp(e)) // ' parametric directions in a space of ' // &
            whole_text(model%ndm), '')
          cycle
        end if
        call smallest_jacobian(model, e, detj, place, status)
        if (status == ok) cycle
        bad = bad + 1
        if (bad > 1) cycle
        first = e
        first_status = status
        worst = detj
        worst_place = place
      end do
      if (bad == 0) cycle
      at = draft%element_place(first)
      fact = 'inverted element at the start: element ' // whole_text(first) // ', det J = ' // &
        write_number(worst) // &
        ' at ' // point_text(worst_place)
      remedy = 'Reverse one direction of the patch (in the plane they turn counter-clockwise)'
      if (draft%origins(i)%command /= 'PATCh') remedy = 'Check its nodes and their order'
      if (first_status /= ok .and. model%mesh%dp(first) < model%ndm) fact = 'element ' // &
        whole_text(first) // &
        ' has no area at ' // point_text(worst_place)
      if (first_status /= ok .and. model%mesh%dp(first) < model%ndm) remedy = &
        'Its control points lie in a point or on a line: check them and their order'
      if (first_status == inverted_element .and. model%mesh%dp(first) < model%ndm) then
        fact = 'element ' // whole_text(first) // ' is folded: its normal turns round near ' // point_text(worst_place)
        remedy = 'Check its control points and their order'
      end if
      if (bad > 1) fact = fact // ' (and ' // whole_text(bad - 1) // &
        ' more elements of this data set)'
      call log%add_error(at, draft%element_name(first), fact, remedy)
    end do
  end subroutine check_geometry

  subroutine smallest_jacobian(model, e, detj, place, status)
    !! Of an element, at its Gauss points (degree + 1 in each direction) and its corners.
    type(model_type), intent(in), target :: model
    integer, intent(in) :: e                     !! element
    real(wp), intent(out) :: detj                !! the first value that is wrong, or the smallest
    real(wp), intent(out) :: place(:)            !! where (ndm)
    integer, intent(out) :: status               !! ok or what is wrong
    real(wp), allocatable :: xe(:, :), we(:), ce(:, :), shp(:), dshp(:, :), d2shp(:, :), &
      dshpx(:, :), xi(:, :), wt(:)
    integer, allocatable :: ix(:)
    real(wp) :: d, x(model%ndm), tau(model%ndm, model%ndm - 1), nrm(model%ndm), largest
    real(wp), allocatable :: normals(:, :)
    integer :: dp, g, ng, nen
    logical :: corner
    real(wp), parameter :: rounding = 1e-10_wp

    dp = model%mesh%dp(e)
    nen = model%mesh%nen(e)
    allocate (ix, source=model%mesh%nodes(model%mesh%node_ptr(e):model%mesh%node_ptr(e + 1) - 1))
    allocate (ce, source=model%mesh%operator(e))
    xe = model%x(:, ix)
    we = model%w(ix)
    allocate (shp(nen), dshp(dp, nen), d2shp((dp*(dp + 1))/2, nen), dshpx(dp, nen))
    call points_to_check(model%mesh%degree(1:dp, e), xi, wt, ng)
    allocate (normals(model%ndm, ng))

    status = ok
    detj = huge(detj)
    largest = 0
    place = 0
    do g = 1, size(xi, 2)
      corner = g > ng
      call shape_functions(model%mesh%degree(1:dp, e), we, ce, xi(:, g), 1, shp, dshp, d2shp, &
        status)
      x = matmul(xe, shp)
      if (status /= ok) then
        place = x
        detj = 0
        return
      end if
      if (dp == model%ndm) then
        call physical_gradient(xe, dshp, dshpx, d, status)
        if (corner .and. d > -rounding*largest) status = ok
      else
        call tangent_frame_at(xe, shp, dshp, x, tau, nrm, d, status)
        if (corner) status = ok
        if (status == ok .and. .not. corner) then
          normals(:, g) = nrm
          if (is_turned(g)) status = inverted_element
        end if
      end if
      largest = max(largest, d)
      if (d < detj .or. status /= ok) then
        detj = d
        place = x
      end if
      if (status /= ok) return
    end do

  contains

    logical function is_turned(g)
      !! The normal of a Gauss point against those of the points before it in each direction.
      integer, intent(in) :: g
      integer :: before, direction, stride

      is_turned = .false.
      stride = 1
      do direction = 1, dp
        before = g - stride
        if (mod((g - 1)/stride, model%mesh%degree(direction, e) + 1) > 0) is_turned = is_turned &
          .or. dot_product(normals(:, g), normals(:, before)) < 0
        stride = stride*(model%mesh%degree(direction, e) + 1)
      end do
    end function is_turned
  end subroutine smallest_jacobian

  subroutine points_to_check(degree, xi, wt, ng)
    integer, intent(in) :: degree(:)                   !! (dp)
    real(wp), allocatable, intent(out) :: xi(:, :)     !! Gauss points, then corners (dp,ng+2**dp)
    real(wp), allocatable, intent(out) :: wt(:)        !! weights of the Gauss points (ng)
    integer, intent(out) :: ng
    integer :: d, k

    ng = product(degree + 1)
    allocate (xi(size(degree), ng + 2**size(degree)), wt(ng))
    call tensor_rule(degree + 1, xi(:, 1:ng), wt)
    do k = 0, 2**size(degree) - 1
      do d = 1, size(degree)
        xi(d, ng + 1 + k) = real(ibits(k, d - 1, 1), wp)
      end do
    end do
  end subroutine points_to_check

  pure function point_text(x) result(text)
    real(wp), intent(in) :: x(:)
    character(:), allocatable :: text    !! (0.5, 2)
    character(16) :: buffer
    integer :: i

    text = '('
    do i = 1, size(x)
      write (buffer, '(g0.5)') x(i)
      text = text // trim(buffer)
      if (i < size(x)) text = text // ', '
    end do
    text = text // ')'
  end function point_text

  subroutine switch_off_unused(model, draft, log)
    !! Dofs that no element has are fixed at 0: those of nodes without elements, and components
    !! beyond an element's ndf.
    type(model_type), intent(inout) :: model
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log
    logical, allocatable :: used(:)
    integer, allocatable :: ndf(:)
    integer :: a, e, k, lonely, first

    call used_nodes(model, used)
    allocate (ndf(model%nn), source=0)
    do e = 1, model%mesh%ne
      do k = model%mesh%node_ptr(e), model%mesh%node_ptr(e + 1) - 1
        a = model%mesh%nodes(k)
        ndf(a) = max(ndf(a), model%materials(model%material_of(e))%element%ndf)
      end do
    end do
    lonely = 0
    first = 0
    do a = 1, model%nn
      if (ndf(a) == model%ndf) cycle
      model%fixed(ndf(a) + 1:, a) = .true.
      model%disp(ndf(a) + 1:, a) = 0
      if (used(a) .or. draft%tied_to(a) /= a .or. .not. draft%defined(a)) cycle
      lonely = lonely + 1
      if (lonely == 1) first = a
    end do
    if (lonely > 0) call log%add_warning(draft%header, 'FEAP', whole_text(lonely) // &
      ' nodes belong to no element (the first: node ' // whole_text(first) // ')', &
      'Their dofs are switched off')
  end subroutine switch_off_unused
end module model_check
